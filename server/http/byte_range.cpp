// SPDX-License-Identifier: Apache-2.0
#include "server/http/byte_range.h"

#include <algorithm>

#include "server/http/number.h"

namespace kerf::net {

std::expected<std::optional<ByteRange>, UnsatisfiableRange> parse_range(std::string_view header,
                                                                        std::uint64_t bytes) {
  constexpr std::string_view kUnit = "bytes=";
  if (!header.starts_with(kUnit)) return std::nullopt;
  header.remove_prefix(kUnit.size());
  const auto dash = header.find('-');
  if (dash == header.npos) return std::nullopt;
  const auto first = parse_number<std::uint64_t>(header.substr(0, dash));
  const auto last = parse_number<std::uint64_t>(header.substr(dash + 1));
  if (dash == 0) {  // a suffix: the last N bytes
    if (!last) return std::nullopt;
    if (*last == 0 || bytes == 0) return std::unexpected(UnsatisfiableRange{});
    const std::uint64_t count = std::min(*last, bytes);
    return ByteRange{bytes - count, count};
  }
  if (!first || (!last && dash + 1 < header.size()) || (last && *last < *first)) {
    return std::nullopt;
  }
  if (*first >= bytes) return std::unexpected(UnsatisfiableRange{});
  return ByteRange{*first, std::min(last.value_or(bytes - 1), bytes - 1) - *first + 1};
}

}  // namespace kerf::net
