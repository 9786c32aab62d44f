// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/stock_contact.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernel/dexel/stock_column.h"
#include "kernel/force/body_contact.h"
#include "kernel/force/contact_patch.h"
#include "kernel/force/stock_faces.h"
#include "kernel/math/tolerance.h"
#include "kernel/piece/bounds.h"

namespace kerf {
namespace {

/// Signed distance of a point (r, h) of the half-plane from a surface, negative inside.
struct Outside {
  double mm;
  double nr, nh;  ///< unit gradient
};

Outside outside(const FrustumPiece& f, double r, double h) {
  const FrustumSide side(f);
  return {side.distance(r, h - f.z0_mm), side.cosine, -side.slope * side.cosine};
}

/// The distance from an arc that other pieces adjoin, or none does, below and above. Where one
/// does, the arc is continued along its tangent, else as a circle.
Outside outside(const ArcPiece& a, double r, double h, bool joined_below, bool joined_above) {
  const double across = r - a.center_r_mm, along = h - a.center_z_mm;
  const auto tangent = [&](bool joined, double end) {
    const double nh = joined ? end / a.radius_mm : (end < 0 ? -1.0 : 1.0);
    const double nr = joined ? half_chord(a.radius_mm, end) / a.radius_mm : 0;
    return Outside{nr * across + nh * along - a.radius_mm, nr, nh};
  };
  const Outside below = joined_below ? tangent(true, a.z0_mm - a.center_z_mm) : tangent(false, -1);
  const Outside above = joined_above ? tangent(true, a.z1_mm - a.center_z_mm) : tangent(false, 1);
  const bool within =
      below.nr * along - below.nh * across >= 0 && above.nr * along - above.nh * across <= 0;
  if (!within) return below.mm > above.mm ? below : above;
  const double n = std::sqrt(across * across + along * along);
  return n > 0 ? Outside{n - a.radius_mm, across / n, along / n} : Outside{-a.radius_mm, 1, 0};
}

/// Signed distance function of a point from a part's side and bottom: exact inside and near the
/// part, convex, with a gradient of at most 1. The top is excluded: a part adjoins the one above,
/// so a point cannot leave through it; nor through the bottom where the part below covers it.
Outside outside(const ConvexPart& part, double r, double h) {
  Outside most{-1e300, 1, 0};
  const std::size_t last = part.pieces.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    const auto* arc = std::get_if<ArcPiece>(&part.pieces[k]);
    const Outside o = arc != nullptr ? outside(*arc, r, h, k > 0 || part.covered, k < last)
                                     : outside(std::get<FrustumPiece>(part.pieces[k]), r, h);
    if (o.mm > most.mm) most = o;
  }
  const double bottom = extent(part.pieces.front()).z0_mm - h;
  return bottom > most.mm && !part.covered ? Outside{bottom, 0, -1} : most;
}

struct Heights {
  double lo, hi;
};
struct Deepest {
  double outside = 0, z = 0;
  bool pruned = true;  ///< no depth of interest is possible; the search was stopped
};

constexpr int kSearchSteps = 60;  ///< each keeps at most 9/10 of the interval of heights
/// A part of a tool at a pose in the frame of a field.
class PlacedPart {
 public:
  PlacedPart(const ConvexPart& part, const ToolPose& pose)
      : part_(part), pose_(pose), reach_(extent(part)) {
    const Bounds box = cylinder_bounds(reach_, pose.tip_mm, pose.axis);
    lo = box.lo_mm;
    hi = box.hi_mm;
  }

  Vec3 lo, hi;  ///< its bounding box

  /// Returns the signed distance at a point, and its gradient in `outward` if that is not null.
  double at(Vec3 point, Vec3* outward = nullptr) const {
    const Vec3 p = point - pose_.tip_mm;
    const double h = dot(p, pose_.axis);
    const Vec3 across = p - pose_.axis * h;
    const double r = length(across);
    const Outside o = outside(part_, r, h);
    if (outward != nullptr) {
      const Vec3 e = r > 0 ? across * (1 / r) : Vec3{};
      *outward = e * o.nr + pose_.axis * o.nh;
    }
    return o.mm;
  }

  /// Returns the heights of a column that are not above the part's top.
  Heights below_top(double x, double y, Heights z) const {
    const Vec3 u = pose_.axis, t = pose_.tip_mm;
    const double rest = reach_.z1_mm - (x - t.x) * u.x - (y - t.y) * u.y;  // u.z (z - t.z) <= rest
    if (u.z > 0) z.hi = std::min(z.hi, t.z + rest / u.z);
    if (u.z < 0) z.lo = std::max(z.lo, t.z + rest / u.z);
    if (u.z == 0 && rest < 0) return {1, 0};
    return z;
  }

  /// Finds the deepest point of a column inside the part. Between two heights a convex function is
  /// above its tangents there. The next height to evaluate is where the tangents meet; the value
  /// there is a lower bound, which shows when no point of the column, or of columns up to
  /// `around_mm` away in x and y, can be more than `threshold_mm` inside, and when the deepest
  /// point has been found.
  Deepest least(double x, double y, Heights z, double threshold_mm, double around_mm = 0) const {
    Tangent a = tangent(x, y, z.lo), b = tangent(x, y, z.hi);
    Deepest found;
    for (int i = 0; i < kSearchSteps; ++i) {
      const bool inner = a.slope() < 0 && b.slope() > 0;
      const double width = b.z - a.z;
      const double meet = inner ? (a.mm - b.mm + b.slope() * width) / (b.slope() - a.slope()) : 0;
      const bool lower = a.mm <= b.mm;
      found = {lower ? a.mm : b.mm, lower ? a.z : b.z, false};
      // A plane below the function: the mean of the two tangent planes that is level in z.
      const double share = inner ? b.slope() / (b.slope() - a.slope()) : (a.slope() < 0 ? 0 : 1);
      const Vec3 g = a.gradient * share + b.gradient * (1 - share);
      const double middle = inner ? a.mm + a.slope() * meet : (share > 0 ? a.mm : b.mm);
      const double bound = middle - (std::abs(g.x) + std::abs(g.y)) * around_mm;
      found.pruned = bound >= -threshold_mm - kDepthEpsilonMm;
      if (found.pruned || !inner || found.outside - middle <= kDepthEpsilonMm) break;
      const Tangent c = tangent(x, y, a.z + std::clamp(meet, 0.1 * width, 0.9 * width));
      (c.slope() < 0 ? a : b) = c;
    }
    return found;
  }

 private:
  struct Tangent {
    double z, mm;
    Vec3 gradient;
    double slope() const { return gradient.z; }
  };
  Tangent tangent(double x, double y, double z) const {
    Vec3 outward;
    const double mm = at({x, y, z}, &outward);
    return {z, mm, outward};
  }

  const ConvexPart& part_;
  ToolPose pose_;
  Extent reach_;
};

/// Accumulates the overlap of a part with the stock: depth, centroid and mean normal.
struct Overlap {
  double depth = 0;
  Vec3 deepest, deepest_outward;
  PatchSum patch;
  Vec3 outward;  ///< sum over samples by their weight
  StockFaces faces;

  Vec3 point() const { return patch.weight() > 0 ? patch.center_mm() : deepest; }
  /// Returns the direction of the push: that of the stock's faces, as far as there are any, towards
  /// which the tool's own surface is turned.
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
    for (std::int32_t j = j0_ / kTileSide; j * kTileSide < j1_; ++j) {
      for (std::int32_t i = i0_ / kTileSide; i * kTileSide < i1_; ++i) {
        const DexelTile* tile = field_.find({i, j});
        const double top = tile == nullptr
                               ? z_.hi
                               : std::min(z_.hi, grid_.z_mm(std::ranges::max(tile->block_top)));
        if (top > z_.lo) search({i * kTileSide, j * kTileSide, kTileSide}, {z_.lo, top}, found);
      }
    }
  }

  /// Adds evenly spaced columns to the overlap's centroid and mean normal.
  void add_samples(Overlap& found) {
    constexpr std::int32_t kAcross = 16;
    const std::int32_t step = std::max(i1_ - i0_, j1_ - j0_) / kAcross + 1;
    const auto first = [step](std::int32_t from, std::int32_t to) {
      return from + ((to - from - 1) % step) / 2;  // Centered in [from, to).
    };
    for (std::int32_t j = first(j0_, j1_); j < j1_; j += step) {
      for (std::int32_t i = first(i0_, i1_); i < i1_; i += step) {
        const double x = grid_.x_mm(i), y = grid_.y_mm(j);
        each_solid(i, j, [&](Heights z) {
          const Heights inside = add_sample(x, y, z, double(step) * step, found);
          if (inside.lo < inside.hi)
            found.faces.add(field_, i, j, inside.lo, inside.hi, double(step) * step);
        });
      }
    }
  }

 private:
  struct Square {
    std::int32_t i, j, side;
  };

  template <typename Visit>
  void each_solid(std::int32_t i, std::int32_t j, Visit visit) {
    const DexelTile* tile = field_.find({i / kTileSide, j / kTileSide});
    if (tile == nullptr) {
      solid_.assign(1, stock_column(field_.stock(), grid_, i, j));
    } else {
      tile->read((j % kTileSide) * kTileSide + i % kTileSide, solid_);
    }
    for (const Dexel& d : solid_) {
      const Heights z = part_.below_top(
          grid_.x_mm(i), grid_.y_mm(j),
          {std::max(z_.lo, grid_.z_mm(d.bottom)), std::min(z_.hi, grid_.z_mm(d.top))});
      if (z.lo < z.hi) visit(z);
    }
  }

  /// Branch and bound: skips a square of columns if none of them can be deeper than what was found.
  void search(Square s, Heights z, Overlap& found) {
    if (s.i >= i1_ || s.j >= j1_ || s.i + s.side <= i0_ || s.j + s.side <= j0_) return;
    if (s.side == 1) return search_column(s.i, s.j, found);
    const double half = s.side / 2.0;
    const double x = grid_.origin_mm.x + (s.i + half) * grid_.pitch_mm;
    const double y = grid_.origin_mm.y + (s.j + half) * grid_.pitch_mm;
    if (part_.least(x, y, z, found.depth, half * grid_.pitch_mm).pruned) return;
    const std::int32_t h = s.side / 2;
    search({s.i, s.j, h}, z, found);
    search({s.i + h, s.j, h}, z, found);
    search({s.i, s.j + h, h}, z, found);
    search({s.i + h, s.j + h, h}, z, found);
  }

  void search_column(std::int32_t i, std::int32_t j, Overlap& found) {
    const double x = grid_.x_mm(i), y = grid_.y_mm(j);
    each_solid(i, j, [&](Heights z) {
      const Deepest d = part_.least(x, y, z, found.depth);
      if (!(-d.outside > found.depth)) return;
      found.depth = -d.outside;
      Vec3 outward;
      part_.at({x, y, d.z}, &outward);
      found.deepest = from_frame(grid_.axis, {x, y, d.z});
      found.deepest_outward = from_frame(grid_.axis, outward);
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
