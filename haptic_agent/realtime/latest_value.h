// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace kerf::agent {

/// Lock-free triple buffer: passes the newest value from one writing thread to one reading thread.
/// Neither waits. The writer owns one slot, the reader another, and the third is exchanged. A write
/// overwrites a value that was not read.
template <typename T>
class LatestValue {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Writer only.
  void write(const T& value) noexcept {
    slots_[back_] = value;
    const std::uint8_t before = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel);
    back_ = before & kIndex;
  }

  /// Reader only. Fetches the newest value. Returns false and leaves `value` unchanged if nothing
  /// was written since the last call.
  bool read(T& value) noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    const std::uint8_t before = middle_.exchange(front_, std::memory_order_acq_rel);
    front_ = before & kIndex;
    value = slots_[front_];
    return true;
  }

 private:
  static constexpr std::uint8_t kIndex = 3;
  static constexpr std::uint8_t kFresh = 4;
  static constexpr std::size_t kCacheLineBytes = 64;

  std::array<T, 3> slots_{};
  alignas(kCacheLineBytes) std::atomic<std::uint8_t> middle_{1};
  alignas(kCacheLineBytes) std::uint8_t back_ = 0;   // slot of the writer
  alignas(kCacheLineBytes) std::uint8_t front_ = 2;  // slot of the reader
};

}  // namespace kerf::agent
