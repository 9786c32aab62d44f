// SPDX-License-Identifier: Apache-2.0
#include "server/store/record_origins.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>

#include "server/platform/random.h"

namespace kerf {
namespace {

std::int64_t stored(std::uint64_t number) { return static_cast<std::int64_t>(number); }
std::uint64_t number_at(const ListRow& row, std::size_t column) {
  return static_cast<std::uint64_t>(std::get<std::int64_t>(row.at(column)));
}

OriginRow origin_row(const ListRow& row) {
  return {number_at(row, 0),
          {std::get<std::string>(row.at(1)), number_at(row, 2), number_at(row, 3)}};
}

}  // namespace

ListRow to_row(const OriginRow& row) {
  const RecordOrigin& origin = row.origin;
  return {stored(row.first), origin.writer, stored(origin.number), stored(origin.clock)};
}

OriginRow new_writer(std::uint64_t first, std::uint64_t clock) {
  std::array<char, 33> text{};
  std::snprintf(text.data(), text.size(), "%016llx%016llx",
                static_cast<unsigned long long>(random_number()),
                static_cast<unsigned long long>(random_number()));
  return {first, {text.data(), first, clock}};
}

RecordOrigins::RecordOrigins(const std::string& session, const JournalParent& parent,
                             const std::vector<ListRow>& rows, std::uint64_t last) {
  for (const ListRow& row : rows) rows_.push_back(origin_row(row));
  if (rows_.empty() || rows_.front().first > 1) {
    const std::string& maker = parent.session.empty() ? session : parent.session;
    rows_.insert(rows_.begin(), {1, {"session " + maker, 1, 1}});
  }
  std::erase_if(rows_, [&](const OriginRow& row) { return row.first > last; });
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    const auto& [first, origin] = rows_[n];
    const std::uint64_t end = n + 1 < rows_.size() ? rows_[n + 1].first : last + 1;
    of_writer_[origin.writer].push_back({origin.number, end - first, first});
    next_clock_ = std::max(next_clock_, origin.clock + (end - first));
  }
  for (auto& [writer, ranges] : of_writer_) make_disjoint(ranges);
}

/// Sorts ranges by number. A record that was merged twice, e.g. the undo of a stroke that is in two
/// parts here, stays in one of them.
void RecordOrigins::make_disjoint(std::vector<Range>& ranges) {
  std::ranges::sort(ranges, {}, &Range::number);
  std::uint64_t end = 0;
  for (Range& range : ranges) {
    const std::uint64_t known = std::min(range.count, end > range.number ? end - range.number : 0);
    range = {range.number + known, range.count - known, range.first + known};
    end = std::max(end, range.number + range.count);
  }
  std::erase_if(ranges, [](const Range& range) { return range.count == 0; });
}

RecordOrigin RecordOrigins::of(std::uint64_t record) const {
  const auto& [first, origin] =
      *std::prev(std::ranges::upper_bound(rows_, record, {}, &OriginRow::first));
  return {origin.writer, origin.number + (record - first), origin.clock + (record - first)};
}

std::optional<std::uint64_t> RecordOrigins::find(const RecordOrigin& origin) const {
  const auto found = of_writer_.find(origin.writer);
  if (found == of_writer_.end()) return std::nullopt;
  const auto after = std::ranges::upper_bound(found->second, origin.number, {}, &Range::number);
  if (after == found->second.begin()) return std::nullopt;
  const auto& [number, count, first] = *std::prev(after);
  if (origin.number - number < count) return first + (origin.number - number);
  return std::nullopt;
}

}  // namespace kerf
