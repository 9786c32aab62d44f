// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string_view>

namespace kerf::net {

/// The range of a file that a response carries.
struct ByteRange {
  std::uint64_t first = 0, count = 0;
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};
struct UnsatisfiableRange {};

/// Parses a Range header for a file of `bytes` bytes (RFC 9110, section 14). Returns nullopt, for
/// the whole file, if the header is empty or malformed or has another unit or several ranges, as
/// the RFC permits. Fails if no byte of the range exists.
std::expected<std::optional<ByteRange>, UnsatisfiableRange> parse_range(std::string_view header,
                                                                        std::uint64_t bytes);

}  // namespace kerf::net
