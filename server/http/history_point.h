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
/// A point in the history of a session: after a record, at a time, or under a name
/// (Matter::record_named).
using HistoryPoint = std::variant<std::uint64_t, WallTime, std::string>;
/// The name of the present, which no other point has.
inline constexpr std::string_view kLive = "live";

/// Whether a text can name a point: UTF-8 of 1 to 64 bytes without control characters and "/".
bool is_point_name(std::string_view name);

/// Reads a time in UTC as RFC 3339 writes it, e.g. 2026-11-22T14:03:00Z, with or without decimals
/// of the second, which are cut to ms. Years are 1970 to 9999.
std::expected<WallTime, std::string> parse_time(std::string_view text);
/// Reads the parameter `at`: the number of a record, a time, or else the name of a version. The
/// error goes on after its name.
std::expected<HistoryPoint, std::string> parse_point(const std::string& text);

/// Returns the record after which the block was as at a point. Blocks until the journal is
/// committed. The response to a time that is still to come, and to a name that no version has, is a
/// 404.
std::expected<std::uint64_t, ApiResponse> find_record(Session& session, const HistoryPoint& point);
/// The same for the text of a parameter `at`, for a record that the session has; null: the last
/// one.
std::expected<std::uint64_t, ApiResponse> find_requested(Session& session, const std::string* at);
/// 404: the session has no such record yet.
ApiResponse no_record(std::uint64_t record);

}  // namespace kerf::net
