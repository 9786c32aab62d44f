// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>

namespace kerf::agent {

/// Lock-free queue of fixed capacity for one writing thread and one reading thread. Neither waits.
template <typename T, std::size_t Capacity>
class SpscRing {
 public:
  static constexpr std::size_t kCapacity = Capacity;

  /// Writer only. Returns false and drops `value` if the ring is full.
  bool push(const T& value) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == kCapacity) return false;
    values_[head % kCapacity] = value;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// Reader only. Returns false and leaves `value` unchanged if the ring is empty.
  bool pop(T& value) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    value = values_[tail % kCapacity];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  static constexpr std::size_t kCacheLineBytes = 64;

  std::array<T, kCapacity> values_{};
  alignas(kCacheLineBytes) std::atomic<std::size_t> head_{0};
  alignas(kCacheLineBytes) std::atomic<std::size_t> tail_{0};
};

}  // namespace kerf::agent
