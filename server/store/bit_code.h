// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kerf {

/// The magnitude of one kind of number: the parameter of its Golomb-Rice code, adapted to the
/// previous numbers as in JPEG-LS (ITU-T T.87, A.5). Encoder and decoder stay in step.
class NumberSize {
 public:
  unsigned low_bits() const {
    unsigned bits = 0;
    while (bits < kBitsMax && (count_ << bits) < sum_) ++bits;
    return bits;
  }
  void learn(std::uint64_t value) {
    sum_ += std::min(value, std::uint64_t{1} << kBitsMax);
    if (++count_ < kMemory) return;
    sum_ /= 2;
    count_ /= 2;
  }

 private:
  static constexpr unsigned kBitsMax = 48;
  static constexpr std::uint64_t kMemory = 32;
  std::uint64_t sum_ = 64, count_ = 1;
};

/// Numbers with a quotient of at least kQuotientMax are written with an explicit length.
inline constexpr unsigned kQuotientMax = 20;
inline constexpr unsigned kLengthBits = 6;

/// Writes bits, the first one into the highest bit of a byte.
class BitWriter {
 public:
  void bits(std::uint64_t value, unsigned count) {
    for (unsigned i = count; i-- > 0;) {
      if (used_ == 0) bytes_.push_back(std::byte{0});
      if (((value >> i) & 1U) != 0) bytes_.back() |= std::byte{0x80} >> used_;
      used_ = (used_ + 1) % 8;
    }
  }
  void number(std::uint64_t value, NumberSize& size) {
    const unsigned low = size.low_bits();
    const std::uint64_t quotient = value >> low;
    if (quotient < kQuotientMax) {
      bits(1, static_cast<unsigned>(quotient) + 1);
      bits(value, low);
    } else {
      const auto length = static_cast<unsigned>(std::bit_width(value));
      bits(0, kQuotientMax);
      bits(length - 1, kLengthBits);
      bits(value, length);
    }
    size.learn(value);
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
  unsigned used_ = 0;
};

/// Reads the output of a BitWriter. Past the end it reads zeros and has failed.
class BitReader {
 public:
  explicit BitReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::uint64_t bits(unsigned count) {
    std::uint64_t value = 0;
    for (unsigned i = 0; i < count; ++i, ++at_) value = (value << 1U) | (bit(at_) ? 1U : 0U);
    return value;
  }
  std::uint64_t number(NumberSize& size) {
    const unsigned low = size.low_bits();
    unsigned quotient = 0;
    while (quotient < kQuotientMax && bits(1) == 0) ++quotient;
    std::uint64_t value = 0;
    if (quotient < kQuotientMax) {
      value = (std::uint64_t{quotient} << low) | bits(low);
    } else {
      value = bits(static_cast<unsigned>(bits(kLengthBits)) + 1);
    }
    size.learn(value);
    return value;
  }
  bool failed() const { return at_ > 8 * bytes_.size(); }
  /// The last byte may have unused bits.
  bool at_end() const { return (at_ + 7) / 8 == bytes_.size(); }

 private:
  bool bit(std::size_t at) const {
    return at < 8 * bytes_.size() &&
           (bytes_[at / 8] & (std::byte{0x80} >> (at % 8))) != std::byte{};
  }
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

}  // namespace kerf
