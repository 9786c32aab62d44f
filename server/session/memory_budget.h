// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

namespace kerf {

/// Limits the memory that a process spends on client data: uploads from their header on, and
/// programs while they run. Thread-safe. Shares may outlive the budget.
class MemoryBudget {
 public:
  /// A part of a budget, returned by its destructor.
  class Share {
   public:
    Share() = default;
    Share(Share&& other) noexcept
        : taken_(std::move(other.taken_)), bytes_(std::exchange(other.bytes_, 0)) {}
    Share& operator=(Share&& other) noexcept {
      std::swap(taken_, other.taken_);
      std::swap(bytes_, other.bytes_);
      return *this;
    }
    ~Share() { reduce(0); }
    /// Returns all but `bytes`.
    void reduce(std::size_t bytes) {
      if (bytes >= bytes_) return;
      *taken_ -= bytes_ - bytes;
      bytes_ = bytes;
    }
    std::size_t bytes() const { return bytes_; }

   private:
    friend class MemoryBudget;
    Share(std::shared_ptr<std::atomic<std::size_t>> taken, std::size_t bytes)
        : taken_(std::move(taken)), bytes_(bytes) {}
    std::shared_ptr<std::atomic<std::size_t>> taken_;
    std::size_t bytes_ = 0;
  };

  explicit MemoryBudget(std::size_t bytes) : bytes_(bytes) {}

  /// Takes a share. Nullopt if fewer bytes are left.
  std::optional<Share> take(std::size_t bytes) {
    std::size_t taken = *taken_;
    do {
      if (bytes > bytes_ - taken) return std::nullopt;
    } while (!taken_->compare_exchange_weak(taken, taken + bytes));
    return Share(taken_, bytes);
  }
  std::size_t taken() const { return *taken_; }

 private:
  std::size_t bytes_;
  std::shared_ptr<std::atomic<std::size_t>> taken_ = std::make_shared<std::atomic<std::size_t>>(0);
};

}  // namespace kerf
