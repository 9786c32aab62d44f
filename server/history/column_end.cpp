// SPDX-License-Identifier: Apache-2.0
#include "server/history/column_end.h"

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

/// Ends whose normal differs more from the requested one belong to another face.
constexpr double kLeastCosine = 0.5;

/// Looks for the nearest end in one field.
class EndSearch {
 public:
  EndSearch(const DexelSnapshot& field, Vec3 place_mm, Vec3 normal)
      : field_(field),
        grid_(field.grid()),
        place_(to_frame(grid_.axis, place_mm)),
        normal_(to_frame(grid_.axis, normal)) {}

  /// Replaces `nearest` if an end of the column is nearer.
  void look(std::int32_t i, std::int32_t j, std::optional<ColumnEnd>& nearest, double within_mm) {
    const ColumnView column = field_.view(i, j);
    for (std::size_t n = 0; n < column.lower.size(); ++n) {
      const EndCodes codes = column.lower_codes.empty() ? EndCodes{} : column.lower_codes[n];
      look(i, j, column.lower[n], codes, nearest, within_mm);
    }
    const Dexel topmost = column.topmost;
    if (topmost.bottom == topmost.top) return;
    look(i, j, topmost, column.topmost_codes, nearest, within_mm);
  }

 private:
  void look(std::int32_t i, std::int32_t j, const Dexel& dexel, const EndCodes& codes,
            std::optional<ColumnEnd>& nearest, double within_mm) {
    for (const bool is_top : {false, true}) {
      const std::int32_t depth = is_top ? dexel.top : dexel.bottom;
      const Vec3 at{grid_.x_mm(i), grid_.y_mm(j), grid_.z_mm(depth)};
      const double distance = length(at - place_);
      if (distance > within_mm || (nearest && distance >= nearest->distance_mm)) continue;
      const NormalCode code = is_top ? codes.top : codes.bottom;
      const Vec3 normal = field_.normal(i, j, depth, is_top, code);
      if (dot(normal, normal_) < kLeastCosine) continue;
      nearest = ColumnEnd{.axis = grid_.axis,
                          .i = i,
                          .j = j,
                          .depth = depth,
                          .is_top = is_top,
                          .at_mm = from_frame(grid_.axis, at),
                          .normal = from_frame(grid_.axis, normal),
                          .distance_mm = distance};
    }
  }

  const DexelSnapshot& field_;
  const DexelGrid& grid_;
  Vec3 place_, normal_;  ///< in the frame of the field
};

/// Columns from `first` up to, not including, `end` whose rays are within a distance of a point.
struct Columns {
  std::int32_t first, end;
};
Columns columns_near(double place_mm, double origin_mm, double pitch_mm, double within_mm,
                     std::int32_t count) {
  const auto column = [&](double at_mm) {
    const double n = std::floor((at_mm - origin_mm) / pitch_mm);
    return static_cast<std::int32_t>(std::clamp(n, -1.0, static_cast<double>(count)));
  };
  return {std::max(column(place_mm - within_mm), 0),
          std::min(column(place_mm + within_mm) + 1, count)};
}

}  // namespace

std::optional<ColumnEnd> nearest_end(const SolidSnapshot& solid, Vec3 place_mm, Vec3 normal,
                                     double within_mm) {
  std::optional<ColumnEnd> nearest;
  for (const DexelSnapshot& field : solid.fields) {
    const DexelGrid& grid = field.grid();
    const Vec3 at = to_frame(grid.axis, place_mm);
    const Columns across =
        columns_near(at.x, grid.origin_mm.x, grid.pitch_mm, within_mm, grid.columns_x);
    const Columns along =
        columns_near(at.y, grid.origin_mm.y, grid.pitch_mm, within_mm, grid.columns_y);
    EndSearch search(field, place_mm, normal);
    for (std::int32_t j = along.first; j < along.end; ++j) {
      for (std::int32_t i = across.first; i < across.end; ++i) {
        search.look(i, j, nearest, within_mm);
      }
    }
  }
  return nearest;
}

}  // namespace kerf
