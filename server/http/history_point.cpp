// SPDX-License-Identifier: Apache-2.0
#include "server/http/history_point.h"

#include <algorithm>
#include <chrono>
#include <optional>

#include "server/http/number.h"
#include "server/http/responses.h"
#include "server/platform/clock.h"
#include "server/store/journal_times.h"
#include "server/store/plain_text.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

constexpr std::size_t kPointNameBytesMax = 64;
constexpr int kDecimals = 3;  ///< significant decimals of a second

/// Parses some digits of a text.
int digits(std::string_view text, std::size_t at, std::size_t count) {
  return parse_number<int>(text.substr(at, count)).value_or(-1);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Whether a text begins with `form`, in which 0 stands for any digit.
bool has_form(std::string_view text, std::string_view form) {
  const auto matches = [](char c, char f) { return f == '0' ? is_digit(c) : c == f; };
  return text.size() >= form.size() &&
         std::ranges::equal(text.substr(0, form.size()), form, matches);
}

/// Parses the decimals of a second, as ms; nullopt if malformed.
std::optional<int> parse_decimals(std::string_view text) {
  if (text.empty()) return 0;
  if (text.front() != '.' || text.size() == 1) return std::nullopt;
  text.remove_prefix(1);
  int ms = 0;
  for (int n = 0; n < kDecimals; ++n) {
    const auto at = static_cast<std::size_t>(n);
    ms = 10 * ms + (at < text.size() ? text[at] - '0' : 0);
  }
  return std::ranges::all_of(text, is_digit) ? std::optional(ms) : std::nullopt;
}

/// Returns a 404: the record is one that a salvaged journal has lost.
ApiResponse lost_record(std::uint64_t base) {
  return error_response(
      404, "no_record",
      "this journal was salvaged: the block is known from record " + std::to_string(base) + " on");
}

}  // namespace

std::expected<WallTime, std::string> parse_time(std::string_view text) {
  constexpr std::string_view kForm = "0000-00-00T00:00:00";
  const auto failed = [] {
    return std::unexpected(
        std::string("must be a time in UTC, as 2026-11-22T14:03:00Z, not before 1970"));
  };
  if (!has_form(text, kForm) || text.back() != 'Z') return failed();
  using std::chrono::days, std::chrono::sys_days, std::chrono::year_month_day;
  const year_month_day date{std::chrono::year(digits(text, 0, 4)),
                            std::chrono::month(static_cast<unsigned>(digits(text, 5, 2))),
                            std::chrono::day(static_cast<unsigned>(digits(text, 8, 2)))};
  const int hour = digits(text, 11, 2), minute = digits(text, 14, 2), second = digits(text, 17, 2);
  text.remove_suffix(1);
  const auto ms = parse_decimals(text.substr(kForm.size()));
  if (!ms || !date.ok() || date.year() < std::chrono::year(1970) || hour > 23 || minute > 59 ||
      second > 59) {
    return failed();
  }
  const auto time = sys_days(date).time_since_epoch() + std::chrono::hours(hour) +
                    std::chrono::minutes(minute) + std::chrono::seconds(second) +
                    std::chrono::milliseconds(*ms);
  return WallTime{std::chrono::duration_cast<std::chrono::milliseconds>(time).count()};
}

bool is_point_name(std::string_view name) {
  return is_plain_text(name, kPointNameBytesMax) && !name.contains('/');
}

std::expected<HistoryPoint, std::string> parse_point(const std::string& text) {
  if (const auto record = parse_number<std::uint64_t>(text)) return *record;
  if (const auto time = parse_time(text)) return *time;
  if (is_point_name(text)) return text;
  return std::unexpected(
      "must be the number of a record, a time in UTC, as 2026-11-22T14:03:00Z, or the name of a "
      "version");
}

std::expected<std::uint64_t, ApiResponse> find_record(Session& session, const HistoryPoint& point) {
  if (const auto* record = std::get_if<std::uint64_t>(&point)) return *record;
  if (const auto* name = std::get_if<std::string>(&point)) {
    const auto named =
        run_and_wait(session.executor(), [&] { return session.matters().record_named(*name); });
    if (named) return *named;
    return std::unexpected(
        error_response(404, "unknown_version",
                       "the session has no version of this name, which is no time either"));
  }
  const WallTime time = std::get<WallTime>(point);
  if (time.ms > Clock::wall_ms()) {
    return std::unexpected(error_response(404, "no_record", "that time is still to come"));
  }
  const auto flushed = session.flush();
  if (!flushed) return std::unexpected(error_response(503, "busy", describe(flushed.error())));
  const auto record = record_at(session.journal_file(), time.ms);
  if (!record) return std::unexpected(history_failure(session, describe(record.error()), {}));
  return *record;
}

std::expected<std::uint64_t, ApiResponse> find_requested(Session& session, const std::string* at) {
  const auto last = [&] {
    return run_and_wait(session.executor(), [&] { return session.sequence(); });
  };
  if (at == nullptr) return last();
  const auto point = parse_point(*at);
  if (!point) return std::unexpected(error_response(400, "bad_at", "at " + point.error()));
  const auto record = find_record(session, *point);
  if (record && *record > last()) return std::unexpected(no_record(*record));
  if (record && *record < session.past().base())
    return std::unexpected(lost_record(session.past().base()));
  return record;
}

ApiResponse no_record(std::uint64_t record) {
  return error_response(404, "no_record",
                        "the session has no record " + std::to_string(record) + " yet");
}

}  // namespace kerf::net
