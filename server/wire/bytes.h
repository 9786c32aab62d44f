// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "kernel/math/vec3.h"

namespace kerf::wire {

/// Writes little-endian fields in sequence. The buffer must be large enough.
class ByteWriter {
 public:
  explicit ByteWriter(std::span<std::byte> out) noexcept : out_(out) {}

  template <std::unsigned_integral T>
  void field(T value) noexcept {
    assert(at_ + sizeof(T) <= out_.size());
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      out_[at_ + i] = static_cast<std::byte>((value >> (8 * i)) & 0xFFU);
    }
    at_ += sizeof(T);
  }
  void field(float value) noexcept { field(std::bit_cast<std::uint32_t>(value)); }
  void field(double value) noexcept { field(std::bit_cast<std::uint64_t>(value)); }
  template <typename T, std::size_t N>
  void field(const std::array<T, N>& values) noexcept {
    for (const T value : values) field(value);
  }
  void field(const Vec3& value) noexcept {
    field(value.x);
    field(value.y);
    field(value.z);
  }
  void field(const Vec3f& value) noexcept {
    field(value.x);
    field(value.y);
    field(value.z);
  }
  void bytes(std::span<const std::byte> values) noexcept {
    assert(at_ + values.size() <= out_.size());
    std::ranges::copy(values, out_.begin() + static_cast<std::ptrdiff_t>(at_));
    at_ += values.size();
  }
  /// Writes a reserved word: four zero bytes.
  void reserved() noexcept { field(std::uint32_t{0}); }

  std::size_t at() const noexcept { return at_; }

 private:
  std::span<std::byte> out_;
  std::size_t at_ = 0;
};

/// Reads little-endian fields in sequence, and records the offset of the first number that is not
/// finite. The buffer must be long enough.
class ByteReader {
 public:
  ByteReader(std::span<const std::byte> in, std::size_t at) noexcept : in_(in), at_(at) {}

  template <std::unsigned_integral T>
  void field(T& value) noexcept {
    assert(at_ + sizeof(T) <= in_.size());
    T bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      const T byte = std::to_integer<T>(in_[at_ + i]);
      bits = static_cast<T>(bits | static_cast<T>(byte << (8 * i)));
    }
    value = bits;
    at_ += sizeof(T);
  }
  void field(float& value) noexcept { real<std::uint32_t>(value); }
  void field(double& value) noexcept { real<std::uint64_t>(value); }
  template <typename T, std::size_t N>
  void field(std::array<T, N>& values) noexcept {
    for (T& value : values) field(value);
  }
  void field(Vec3& value) noexcept {
    field(value.x);
    field(value.y);
    field(value.z);
  }
  void field(Vec3f& value) noexcept {
    field(value.x);
    field(value.y);
    field(value.z);
  }
  /// Skips a reserved word without checking it, so that a newer peer may use it.
  void reserved() noexcept {
    std::uint32_t skipped = 0;
    field(skipped);
  }

  /// Returns the next `count` bytes.
  std::span<const std::byte> bytes(std::size_t count) noexcept {
    assert(at_ + count <= in_.size());
    at_ += count;
    return in_.subspan(at_ - count, count);
  }

  std::size_t at() const noexcept { return at_; }
  /// Offset of the first number that is not finite, or 0 if there is none.
  std::size_t not_finite_at() const noexcept { return not_finite_at_; }

 private:
  template <typename Bits, typename Real>
  void real(Real& value) noexcept {
    const std::size_t at = at_;
    Bits bits = 0;
    field(bits);
    value = std::bit_cast<Real>(bits);
    if (not_finite_at_ == 0 && !std::isfinite(value)) not_finite_at_ = at;
  }

  std::span<const std::byte> in_;
  std::size_t at_;
  std::size_t not_finite_at_ = 0;
};

}  // namespace kerf::wire
