// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/stock_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "kernel/force/body_contact.h"
#include "kernel/force/contact_patch.h"
#include "kernel/force/placed_part.h"
#include "kernel/force/stock_faces.h"
#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Accumulates the overlap of a part with the stock: depth, centroid and mean normal.
struct Overlap {
  double depth = 0;
  Vec3 deepest, deepest_outward;
  PatchSum patch;
  Vec3 outward;  ///< sum over samples by their weight
  StockFaces faces;

  Vec3 point() const { return patch.weight() > 0 ? patch.center_mm() : deepest; }
  /// Returns the direction of the push: that of the stock's faces that are turned towards the
  /// tool's own surface, if there are any.
  Vec3 push() const {
    const Vec3 own = normalized(outward == Vec3{} ? deepest_outward : outward) * -1;
    const Vec3 face = faces.towards(own);
    return face == Vec3{} ? own : face;
  }
};

/// Contact of one part with one field, in the field's frame.
class FieldContact {
 public:
  FieldContact(const DexelField& field, const PlacedPart& part)
      : field_(field), grid_(field.grid()), part_(part) {
    const auto first = [&](double v, double origin, std::int32_t n) {
      const double i = std::ceil((v - origin) / grid_.pitch_mm - 0.5);
      return static_cast<std::int32_t>(std::clamp(i, 0.0, double(n)));
    };
    i0_ = first(part.lo.x, grid_.origin_mm.x, grid_.columns_x);
    i1_ = first(part.hi.x, grid_.origin_mm.x, grid_.columns_x);
    j0_ = first(part.lo.y, grid_.origin_mm.y, grid_.columns_y);
    j1_ = first(part.hi.y, grid_.origin_mm.y, grid_.columns_y);
    z_ = {std::max(part.lo.z, grid_.origin_mm.z),
          std::min(part.hi.z, grid_.z_mm(grid_.height_quanta))};
  }

  bool beside() const { return i0_ >= i1_ || j0_ >= j1_ || z_.lo >= z_.hi; }

  /// Updates the overlap's depth by the deepest solid point.
  void find_deepest(Overlap& found) {
    each_tile([&](Square tile) { search(tile, found); });
  }

  /// Adds evenly spaced columns of the overlap to its centroid and mean normal.
  void add_samples(Overlap& found) {
    narrow();
    if (beside()) return;
    constexpr std::int32_t kAcross = 16;
    const StockFaces::Steps steps{(i1_ - i0_) / kAcross + 1, (j1_ - j0_) / kAcross + 1};
    const double area = double(steps.i) * steps.j;
    const auto first = [](std::int32_t from, std::int32_t to, std::int32_t step) {
      return from + ((to - from - 1) % step) / 2;  // Centered in [from, to).
    };
    for (std::int32_t j = first(j0_, j1_, steps.j); j < j1_; j += steps.j) {
      for (std::int32_t i = first(i0_, i1_, steps.i); i < i1_; i += steps.i) {
        const double x = grid_.x_mm(i), y = grid_.y_mm(j);
        each_solid(i, j, [&](Heights z) {
          const Heights inside = add_sample(x, y, z, area, found);
          if (inside.lo < inside.hi) found.faces.add(field_, i, j, steps, inside.lo, inside.hi);
        });
      }
    }
  }

 private:
  static constexpr std::int32_t kBlockSide = kTileSide / kTileBlocksAcross;
  struct Square {
    std::int32_t i, j, side;
  };
  struct Rectangle {
    std::int32_t i0, j0, i1, j1;  ///< the last ones are excluded
  };

  template <typename Visit>
  void each_solid(std::int32_t i, std::int32_t j, Visit visit) {
    for (const Dexel& d : field_.column(i, j, solid_)) {
      const Heights z = part_.below_top(
          grid_.x_mm(i), grid_.y_mm(j),
          {std::max(z_.lo, grid_.z_mm(d.bottom)), std::min(z_.hi, grid_.z_mm(d.top))});
      if (z.lo < z.hi) visit(z);
    }
  }

  template <typename Visit>
  void each_tile(Visit visit) const {
    for (std::int32_t j = j0_ / kTileSide; j * kTileSide < j1_; ++j) {
      for (std::int32_t i = i0_ / kTileSide; i * kTileSide < i1_; ++i) {
        visit(Square{i * kTileSide, j * kTileSide, kTileSide});
      }
    }
  }

  /// Narrows the columns to those of the blocks that may hold a solid point of the part, so that
  /// the samples are as dense for a small overlap as for a large one.
  void narrow() {
    Rectangle all{i1_, j1_, i0_, j0_};
    each_tile([&](Square tile) { extend(tile, all); });
    i0_ = all.i0, j0_ = all.j0, i1_ = all.i1, j1_ = all.j1;
  }

  /// Extends a rectangle by the blocks of a square that may hold a solid point of the part.
  void extend(Square s, Rectangle& all) const {
    const std::int32_t i0 = std::max(s.i, i0_), i1 = std::min(s.i + s.side, i1_);
    const std::int32_t j0 = std::max(s.j, j0_), j1 = std::min(s.j + s.side, j1_);
    if (i0 >= i1 || j0 >= j1) return;
    if (i0 >= all.i0 && i1 <= all.i1 && j0 >= all.j0 && j1 <= all.j1) return;
    if (beyond(s, 0)) return;
    if (s.side > kBlockSide) {
      for (const Square quarter : quarters(s)) extend(quarter, all);
      return;
    }
    all = {std::min(all.i0, i0), std::min(all.j0, j0), std::max(all.i1, i1), std::max(all.j1, j1)};
  }

  /// Returns whether no column of a square is more than `threshold_mm` deep in the part.
  bool beyond(Square s, double threshold_mm) const {
    const Heights z{z_.lo, top_mm(s)};
    if (z.lo >= z.hi) return true;
    const double half = s.side / 2.0;
    const double x = grid_.origin_mm.x + (s.i + half) * grid_.pitch_mm;
    const double y = grid_.origin_mm.y + (s.j + half) * grid_.pitch_mm;
    return part_.least(x, y, z, threshold_mm, half * grid_.pitch_mm).pruned;
  }

  /// Returns a height that no column of a square within a tile exceeds.
  double top_mm(Square s) const {
    const DexelTile* tile = field_.find({s.i / kTileSide, s.j / kTileSide});
    if (tile == nullptr) return z_.hi;
    const std::int32_t i0 = s.i % kTileSide / kBlockSide, j0 = s.j % kTileSide / kBlockSide;
    const std::int32_t across = std::max(1, s.side / kBlockSide);
    std::int32_t top = 0;
    for (std::int32_t j = j0; j < j0 + across; ++j) {
      for (std::int32_t i = i0; i < i0 + across; ++i) {
        top = std::max(top, tile->block_top[std::size_t(j * kTileBlocksAcross + i)]);
      }
    }
    return std::min(z_.hi, grid_.z_mm(top));
  }

  static std::array<Square, 4> quarters(Square s) {
    const std::int32_t h = s.side / 2;
    return {{{s.i, s.j, h}, {s.i + h, s.j, h}, {s.i, s.j + h, h}, {s.i + h, s.j + h, h}}};
  }

  /// Branch and bound: skips a square of columns if none can be deeper than the deepest one so far.
  void search(Square s, Overlap& found) {
    if (s.i >= i1_ || s.j >= j1_ || s.i + s.side <= i0_ || s.j + s.side <= j0_) return;
    if (s.side == 1) return search_column(s.i, s.j, found);
    if (beyond(s, found.depth)) return;
    for (const Square quarter : quarters(s)) search(quarter, found);
  }

  void search_column(std::int32_t i, std::int32_t j, Overlap& found) {
    const double x = grid_.x_mm(i), y = grid_.y_mm(j);
    each_solid(i, j, [&](Heights z) {
      const Deepest d = part_.least(x, y, z, found.depth);
      if (!(-d.outside > found.depth)) return;
      found.depth = -d.outside;
      found.deepest = from_frame(grid_.axis, {x, y, d.z});
      found.deepest_outward = from_frame(grid_.axis, part_.exit_direction({x, y, d.z}));
    });
  }

  /// Returns the heights of the column that are inside the part.
  Heights add_sample(double x, double y, Heights z, double area, Overlap& found) const {
    const Deepest d = part_.least(x, y, z, 0);
    if (!(d.outside < 0)) return {1, 0};
    const auto edge = [&](double in, double out) {
      if (part_.at({x, y, out}) <= 0) return out;
      for (int i = 0; i < 24; ++i) {
        const double middle = (in + out) / 2;
        (part_.at({x, y, middle}) <= 0 ? in : out) = middle;
      }
      return in;
    };
    const double bottom = edge(d.z, z.lo), top = edge(d.z, z.hi);
    const Vec3 p{x, y, (bottom + top) / 2};
    Vec3 outward;
    const double weight = -part_.at(p, &outward) * (top - bottom) * area;
    if (!(weight > 0)) return {1, 0};
    found.patch.add(from_frame(grid_.axis, p), weight);
    found.outward = found.outward + from_frame(grid_.axis, outward) * weight;
    return {bottom, top};
  }

  const DexelField& field_;
  const DexelGrid& grid_;
  const PlacedPart& part_;
  std::int32_t i0_, i1_, j0_, j1_;  ///< columns within the part's bounding box
  Heights z_;
  std::vector<Dexel> solid_;
};

Overlap overlap(const ConvexPart& part, const ToolPose& pose, std::span<const DexelField> fields,
                double allowance_mm, bool whole) {
  Overlap found;
  found.depth = allowance_mm;
  const auto each = [&](auto visit) {
    for (const DexelField& field : fields) {
      const RayAxis axis = field.grid().axis;
      const PlacedPart placed(part, {to_frame(axis, pose.tip_mm), to_frame(axis, pose.axis)});
      FieldContact contact(field, placed);
      if (contact.beside()) return;  // Disjoint in one field means disjoint in all.
      visit(contact);
    }
  };
  each([&](FieldContact& contact) { contact.find_deepest(found); });
  if (whole && found.depth > allowance_mm) {
    each([&](FieldContact& contact) { contact.add_samples(found); });
  }
  return found;
}

/// Returns the contact of parts with the stock.
BodyContact contact_of(std::span<const ConvexPart> parts, const ToolPose& pose,
                       std::span<const DexelField> fields, const ForceSettings& settings,
                       double allowance_mm) {
  BodyContact contact;
  for (const ConvexPart& part : parts) {
    const Overlap found = overlap(part, pose, fields, allowance_mm, true);
    const double depth = found.depth - allowance_mm;
    if (!(depth > 0)) continue;
    ContactPlane plane{found.point(),   found.push(), depth, settings.contact_stiffness_n_per_mm,
                       kContactReachMm, true};
    const double height_mm = dot(found.deepest - pose.tip_mm, pose.axis);
    if (!touches_with_a_point(part, height_mm)) found.patch.place(plane);
    contact.add(plane);
  }
  return contact;
}

}  // namespace

StockContact stock_contact(const Tool& tool, const ToolPose& pose,
                           std::span<const DexelField> fields, const ForceSettings& settings,
                           double allowance_mm) {
  BodyContact contact = contact_of(tool.non_cutting_parts, pose, fields, settings, allowance_mm);
  const std::span<const ContactPlane> planes = contact.shared();
  StockContact sum{.wrench = wrench_of(planes, pose, settings.pivot_mm)};
  for (const ContactPlane& plane : planes) sum.depth_mm = std::max(sum.depth_mm, plane.depth_mm);
  return sum;
}

void stock_planes(std::span<const ConvexPart> parts, const ToolPose& pose,
                  std::span<const DexelField> fields, const ForceSettings& settings,
                  double allowance_mm, std::vector<ContactPlane>& out) {
  BodyContact contact = contact_of(parts, pose, fields, settings, allowance_mm);
  const std::span<const ContactPlane> planes = contact.shared();
  out.insert(out.end(), planes.begin(), planes.end());
}

double deepest_stock_contact(const Tool& tool, const ToolMotion& motion,
                             std::span<const DexelField> fields, double allowance_mm) {
  constexpr double kPosesMax = 256;
  double thinnest = tool.whole_radius_mm;
  for (const ConvexPart& part : tool.non_cutting_parts) {
    thinnest = std::min(thinnest, extent(part).radius_mm);
  }
  const double path = motion.travel_mm + motion.turn_rad * tool.whole_length_mm;
  const double n = std::clamp(std::ceil(path / (thinnest / 2)), 1.0, kPosesMax);
  double deepest = 0;
  for (double k = 1; k <= n; ++k) {
    const ToolPose pose = k == n ? motion.to : motion.at(k / n);
    for (const ConvexPart& part : tool.non_cutting_parts) {
      const Overlap found = overlap(part, pose, fields, allowance_mm, false);
      deepest = std::max(deepest, found.depth - allowance_mm);
    }
  }
  return deepest;
}

}  // namespace kerf
