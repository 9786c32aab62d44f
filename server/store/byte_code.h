// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kernel/math/vec3.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// Writes little-endian numbers; doubles as their IEEE 754 bits.
class ByteWriter {
 public:
  template <typename Unsigned>
  void put(Unsigned value) {
    for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
      bytes_.push_back(static_cast<std::byte>((value >> (8 * i)) & 0xFFU));
    }
  }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  void put(Vec3 value) {
    put(value.x);
    put(value.y);
    put(value.z);
  }
  void put(const ToolPose& pose) {
    put(pose.tip_mm);
    put(pose.axis);
  }
  void put(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  /// Writes the length, then the bytes.
  void put_text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    put(std::as_bytes(std::span(text)));
  }
  void reserve(std::size_t size) { bytes_.reserve(size); }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads the output of a ByteWriter. Past the end it reads zeros and is truncated.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename Unsigned>
  Unsigned get() {
    if (bytes_.size() < sizeof(Unsigned)) {
      bytes_ = {};
      truncated_ = true;
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
      value |= std::to_integer<std::uint64_t>(bytes_[i]) << (8 * i);
    }
    bytes_ = bytes_.subspan(sizeof(Unsigned));
    return static_cast<Unsigned>(value);
  }
  double get_double() { return std::bit_cast<double>(get<std::uint64_t>()); }
  Vec3 get_vec3() {
    const double x = get_double();
    const double y = get_double();
    const double z = get_double();
    return {x, y, z};
  }
  ToolPose get_pose() {
    const Vec3 tip_mm = get_vec3();
    return {tip_mm, get_vec3()};
  }
  std::string get_text() {
    const auto bytes = get_bytes(get<std::uint32_t>());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  /// Returns the next bytes; empty if fewer are left.
  std::span<const std::byte> get_bytes(std::size_t count) {
    if (bytes_.size() < count) {
      bytes_ = {};
      truncated_ = true;
      return {};
    }
    const auto first = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return first;
  }
  bool truncated() const { return truncated_; }
  bool at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::byte> bytes_;
  bool truncated_ = false;
};

}  // namespace kerf
