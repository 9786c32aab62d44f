// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <variant>

#include "server/http/api_call.h"
#include "server/session/session.h"

namespace kerf::net {

/// A moment, ms since 1970, UTC.
struct WallTime {
  std::int64_t ms = 0;
};
/// A point in the history of a session: after a record, at a time, or under a name
/// (Matter::record_named).
using HistoryPoint = std::variant<std::uint64_t, WallTime, std::string>;
/// The reserved name of the present.
inline constexpr std::string_view kLive = "live";

/// Whether a text can name a point: 1 to 64 bytes of UTF-8 without control characters and "/".
bool is_point_name(std::string_view name);

/// Parses a UTC time in RFC 3339 format, e.g. 2026-11-22T14:03:00Z. Optional decimals of the second
/// are cut to ms. Years are 1970 to 9999.
std::expected<WallTime, std::string> parse_time(std::string_view text);
/// Parses the parameter `at`: the number of a record, a time, or else the name of a version. The
/// error continues a sentence that begins with the parameter's name.
std::expected<HistoryPoint, std::string> parse_point(const std::string& text);

/// Returns the record after which the block was in the state of a point. Blocks until the journal
/// is committed. A 404 for a future time and for an unknown name.
std::expected<std::uint64_t, ApiResponse> find_record(Session& session, const HistoryPoint& point);
/// Like find_record(), for the text of a parameter `at`. The record must exist. Null means the last
/// record.
std::expected<std::uint64_t, ApiResponse> find_requested(Session& session, const std::string* at);
/// Returns a 404: the session has no such record yet.
ApiResponse no_record(std::uint64_t record);

}  // namespace kerf::net
