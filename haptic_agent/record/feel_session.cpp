// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/record/feel_session.h"

#include <cmath>
#include <sstream>
#include <vector>

#include "haptic_agent/device/ranges.h"

namespace kerf::agent {
namespace {

/// Returns the numbers in a text of the metadata. Empty unless there are `count` of them within
/// ±most.
std::vector<double> numbers(const mcap::Texts& texts, const char* key, std::size_t count,
                            double most) {
  const auto found = texts.find(key);
  if (found == texts.end()) return {};
  std::istringstream in(found->second);
  std::vector<double> values;
  for (double value = 0; in >> value;) values.push_back(value);
  for (const double value : values) {
    if (!(std::abs(value) <= most)) return {};
  }
  if (values.size() != count) values.clear();
  return values;
}

}  // namespace

std::expected<DevicePlace, std::string> place_of(const Recording& recording) {
  const auto low = numbers(recording.about, "stock_min_mm", 3, kPlaceMaxMm);
  const auto high = numbers(recording.about, "stock_max_mm", 3, kPlaceMaxMm);
  const auto pivot = numbers(recording.about, "pivot_mm", 1, kPivotMaxMm);
  if (low.empty() || high.empty() || pivot.empty() || pivot[0] < 0) {
    return std::unexpected("does not state the place of its stock and the pivot");
  }
  return DevicePlace{
      .stock = {.min_mm = {low[0], low[1], low[2]}, .max_mm = {high[0], high[1], high[2]}},
      .pivot_mm = pivot[0],
      .participant = 1,
      .tools = {recording.ticks.front().tool_id},
      .tool = recording.ticks.front().tool_id};
}

}  // namespace kerf::agent
