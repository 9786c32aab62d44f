// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>

#include "server/wire/types.h"

namespace kerf::agent {

/// Samples on their way from the servo thread to the link thread: single writer, single reader,
/// fixed size, no waiting. At 1 kHz it holds one second, by which the link thread may be late.
class SampleRing {
 public:
  static constexpr std::size_t kCapacity = 1024;

  /// Servo thread. False if the ring is full: the sample is lost, and the next one stands for both.
  bool push(const wire::MotionSample& sample) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == kCapacity) return false;
    samples_[head % kCapacity] = sample;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// Link thread. False if the ring is empty.
  bool pop(wire::MotionSample& sample) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    sample = samples_[tail % kCapacity];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  static constexpr std::size_t kCacheLineBytes = 64;

  std::array<wire::MotionSample, kCapacity> samples_{};
  alignas(kCacheLineBytes) std::atomic<std::size_t> head_{0};
  alignas(kCacheLineBytes) std::atomic<std::size_t> tail_{0};
};

}  // namespace kerf::agent
