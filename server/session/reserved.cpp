// SPDX-License-Identifier: Apache-2.0
#include "server/session/reserved.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <variant>

#include "server/rights/rights.h"

namespace kerf {
namespace {

constexpr std::array kCoordinates = {&Vec3::x, &Vec3::y, &Vec3::z};

Bounds bounds_of_stock(const SculptureSettings& settings) {
  if (const auto* box = std::get_if<BoxStock>(&settings.stock)) return {box->min_mm, box->max_mm};
  const auto& cylinder = std::get<CylinderStock>(settings.stock);
  const double radius = cylinder.radius_mm;
  return {{cylinder.center_x_mm - radius, cylinder.center_y_mm - radius, cylinder.min_z_mm},
          {cylinder.center_x_mm + radius, cylinder.center_y_mm + radius, cylinder.max_z_mm}};
}

bool overlaps(const Bounds& one, const Bounds& other) {
  return std::ranges::all_of(kCoordinates, [&](auto coordinate) {
    return one.lo_mm.*coordinate < other.hi_mm.*coordinate &&
           other.lo_mm.*coordinate < one.hi_mm.*coordinate;
  });
}

}  // namespace

Bounds swept_bounds(const MoveTool& move, const Tool& tool, double margin_mm) {
  // An axis that turns from a to b deviates from the chord between them by at most 1 - cos(angle /
  // 2).
  const Vec3 chord = move.to.axis - move.from.axis;
  const double sagitta = 1 - std::sqrt(std::max(0.0, 1 - dot(chord, chord) / 4));
  const double beyond_mm = tool.radius_mm + tool.length_mm * sagitta + margin_mm;
  Bounds bounds;
  for (const auto coordinate : kCoordinates) {
    const auto [tip_low, tip_high] =
        std::minmax(move.from.tip_mm.*coordinate, move.to.tip_mm.*coordinate);
    const auto [axis_low, axis_high] =
        std::minmax(move.from.axis.*coordinate, move.to.axis.*coordinate);
    bounds.lo_mm.*coordinate = tip_low + tool.length_mm * std::min(0.0, axis_low) - beyond_mm;
    bounds.hi_mm.*coordinate = tip_high + tool.length_mm * std::max(0.0, axis_high) + beyond_mm;
  }
  return bounds;
}

Reserved::Reserved(const SculptureSettings& settings)
    : stock_(bounds_of_stock(settings)), margin_mm_(settings.tolerance_mm) {}

void Reserved::set(const std::vector<Region>& regions) {
  regions_.clear();
  for (Region region : regions) {
    if (!overlaps(stock_, {region.min_mm, region.max_mm})) continue;
    for (const auto coordinate : kCoordinates) {
      region.min_mm.*coordinate = std::max(region.min_mm.*coordinate, stock_.lo_mm.*coordinate);
      region.max_mm.*coordinate = std::min(region.max_mm.*coordinate, stock_.hi_mm.*coordinate);
    }
    regions_.push_back(std::move(region));
  }
}

std::optional<Rejection> Reserved::judge(const ParticipantState& state, const MoveTool& move,
                                         const Tool& tool) const {
  if (regions_.empty() || may(state.participant.role, Action::kModerate)) return std::nullopt;
  const Bounds swept = swept_bounds(move, tool, margin_mm_);
  for (const Region& region : regions_) {
    const bool is_theirs =
        (region.participant != 0 && region.participant == state.participant.id) ||
        (!region.person.empty() && region.person == state.person);
    if (is_theirs || !overlaps(swept, {region.min_mm, region.max_mm})) continue;
    return Rejection{
        wire::ErrorCode::kReserved,
        "region " + std::to_string(region.id) + " is reserved" +
            (region.participant != 0 ? " for participant " + std::to_string(region.participant)
                                     : "")};
  }
  return std::nullopt;
}

}  // namespace kerf
