// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace kerf::agent {

/// Hands the newest value from one writing thread to one reading thread. Neither ever waits: three
/// slots are exchanged, one being written, one being read, and one in between. Older values that
/// the reader did not fetch in time are lost, which is the purpose.
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

  /// Reader only: fetches the newest value; false and `value` untouched if there is none newer than
  /// at the last call.
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
  alignas(kCacheLineBytes) std::uint8_t back_ = 0;   // the writer's
  alignas(kCacheLineBytes) std::uint8_t front_ = 2;  // the reader's
};

}  // namespace kerf::agent
