// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <variant>

#include "server/http/api.h"

namespace kerf::net {

/// A moment, ms since 1970, UTC.
struct WallTime {
  std::int64_t ms = 0;
};
/// A point in the history of a session: after a record, or at a time.
using HistoryPoint = std::variant<std::uint64_t, WallTime>;

/// Reads a time in UTC as RFC 3339 writes it, e.g. 2026-11-22T14:03:00Z, with or without decimals
/// of the second, which are cut to ms. Years are 1970 to 9999.
std::expected<WallTime, std::string> parse_time(std::string_view text);
/// Reads the parameter `at`: the number of a record, or a time. The error goes on after its name.
std::expected<HistoryPoint, std::string> parse_point(const std::string& text);

/// Returns the record after which the block was as at a point. Blocks until the journal is
/// committed. The response to a time that is still to come is a 404.
std::expected<std::uint64_t, ApiResponse> find_record(Session& session, const HistoryPoint& point);
/// 404: the session has no such record yet.
ApiResponse no_record(std::uint64_t record);

}  // namespace kerf::net
