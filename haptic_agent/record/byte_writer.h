// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kerf::agent::mcap {

static_assert(std::endian::native == std::endian::little, "MCAP and CDR are written as they are");

using Bytes = std::vector<std::byte>;
using Texts = std::map<std::string, std::string>;

/// Appends numbers and texts in MCAP's format: little-endian, texts and maps after their length in
/// bytes.
class ByteWriter {
 public:
  explicit ByteWriter(Bytes& bytes) : bytes_(bytes) {}

  template <typename T>
    requires std::integral<T> || std::floating_point<T>
  void number(T value) {
    raw(std::as_bytes(std::span(&value, 1)));
  }
  void raw(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    raw(std::as_bytes(std::span(text)));
  }
  void texts(const Texts& texts) {
    std::size_t size = 0;
    for (const auto& [key, value] : texts) {
      size += 2 * sizeof(std::uint32_t) + key.size() + value.size();
    }
    number(static_cast<std::uint32_t>(size));
    for (const auto& [key, value] : texts) {
      text(key);
      text(value);
    }
  }

 private:
  Bytes& bytes_;
};

/// Reads the formats of ByteWriter. A read beyond the end returns zeros; `good` is false from then
/// on.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}

  template <typename T>
    requires std::integral<T> || std::floating_point<T>
  T number() noexcept {
    T value{};
    const auto from = raw(sizeof value);
    if (from.size() == sizeof value) std::memcpy(&value, from.data(), sizeof value);
    return value;
  }
  std::span<const std::byte> raw(std::uint64_t size) noexcept {
    if (size > bytes_.size()) {
      failed_ = true;
      bytes_ = {};
      return {};
    }
    const auto result = bytes_.first(static_cast<std::size_t>(size));
    bytes_ = bytes_.subspan(static_cast<std::size_t>(size));
    return result;
  }
  std::string text() {
    const auto from = raw(number<std::uint32_t>());
    return {reinterpret_cast<const char*>(from.data()), from.size()};
  }
  Texts texts() {
    ByteReader inside(raw(number<std::uint32_t>()));
    Texts texts;
    while (inside.left() > 0 && inside.good()) {
      std::string key = inside.text();
      texts[std::move(key)] = inside.text();
    }
    failed_ = failed_ || !inside.good();
    return texts;
  }
  void skip(std::uint64_t size) noexcept { raw(size); }

  std::size_t left() const noexcept { return bytes_.size(); }
  bool good() const noexcept { return !failed_; }

 private:
  std::span<const std::byte> bytes_;
  bool failed_ = false;
};

}  // namespace kerf::agent::mcap
