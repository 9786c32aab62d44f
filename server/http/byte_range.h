// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string_view>

namespace kerf::net {

/// Bytes of a file that an answer carries.
struct ByteRange {
  std::uint64_t first = 0, count = 0;
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};
struct UnsatisfiableRange {};

/// What a Range header asks of a file with so many bytes (RFC 9110, section 14). None: everything,
/// also where the header is malformed, names another unit or several ranges, as the RFC allows. An
/// error: nothing of what it asks for exists.
std::expected<std::optional<ByteRange>, UnsatisfiableRange> parse_range(std::string_view header,
                                                                        std::uint64_t bytes);

}  // namespace kerf::net
