// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "server/session/memory_budget.h"

namespace kerf::net {

/// Grants memory to uploads, each from its header until it has been handled. One client gets at
/// most half of it and so cannot lock out other clients. Thread-safe.
class UploadBudget {
  struct Held {
    std::mutex mutex;
    std::map<std::string, std::size_t> by_client;
  };

 public:
  enum class Error { kClientHasTooMuch, kNoneLeft };

  /// A part of the budget, returned by its destructor.
  class Share {
   public:
    Share() = default;
    Share(Share&&) = default;
    Share& operator=(Share&& other) noexcept {
      std::swap(memory_, other.memory_);
      std::swap(held_, other.held_);
      std::swap(client_, other.client_);
      return *this;
    }
    ~Share() {
      if (!held_) return;
      const std::scoped_lock lock(held_->mutex);
      const auto found = held_->by_client.find(client_);
      found->second -= memory_.bytes();
      if (found->second == 0) held_->by_client.erase(found);
    }

   private:
    friend class UploadBudget;
    Share(MemoryBudget::Share memory, std::shared_ptr<Held> held, std::string client)
        : memory_(std::move(memory)), held_(std::move(held)), client_(std::move(client)) {}
    MemoryBudget::Share memory_;
    std::shared_ptr<Held> held_;
    std::string client_;
  };

  explicit UploadBudget(std::size_t bytes) : client_bytes_(bytes / 2), memory_(bytes) {}

  /// Takes a share for an upload of `bytes` bytes, or returns the reason for rejecting it.
  /// `client`: its network (network_of).
  std::expected<Share, Error> take(const std::string& client, std::size_t bytes) {
    const std::scoped_lock lock(held_->mutex);
    const auto found = held_->by_client.find(client);
    const std::size_t held = found == held_->by_client.end() ? 0 : found->second;
    if (bytes > client_bytes_ - held) return std::unexpected(Error::kClientHasTooMuch);
    auto memory = memory_.take(bytes);
    if (!memory) return std::unexpected(Error::kNoneLeft);
    held_->by_client[client] += bytes;
    return Share(*std::move(memory), held_, client);
  }
  /// Maximum for one client.
  std::size_t client_bytes() const { return client_bytes_; }

 private:
  std::size_t client_bytes_;
  MemoryBudget memory_;
  std::shared_ptr<Held> held_ = std::make_shared<Held>();
};

}  // namespace kerf::net
