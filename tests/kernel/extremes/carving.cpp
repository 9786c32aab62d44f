// SPDX-License-Identifier: Apache-2.0
#include "tests/kernel/extremes/carving.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

namespace kerf::test {
namespace {

using Random = std::mt19937_64;

double in(Random& random, double a, double b) {
  return std::uniform_real_distribution<double>(a, b)(random);
}

/// Returns a random point on the surface of an upright piece at the origin: radial distance and
/// height.
struct Spot {
  double radial, height;
};

Spot profile_point(const ToolPiece& piece, Random& random) {
  if (const auto* b = std::get_if<BallPiece>(&piece)) {
    const double a = in(random, -std::numbers::pi / 2, std::numbers::pi / 2);
    return {b->radius_mm * std::cos(a), b->center_mm + b->radius_mm * std::sin(a)};
  }
  if (const auto* f = std::get_if<FrustumPiece>(&piece)) {
    if (in(random, 0, 1) < 0.3) return {f->r0_mm * in(random, 0, 1), f->z0_mm};
    const double share = in(random, 0, 1) * in(random, 0, 1);  // Mostly near the tip.
    return {f->r0_mm + (f->r1_mm - f->r0_mm) * share, f->z0_mm + (f->z1_mm - f->z0_mm) * share};
  }
  const auto& a = std::get<ArcPiece>(piece);
  const double z = in(random, a.z0_mm, a.z1_mm), dz = z - a.center_z_mm;
  return {std::max(0.0, a.center_r_mm + std::sqrt(a.radius_mm * a.radius_mm - dz * dz)), z};
}

Vec3 surface_point(const Tool& tool, const ToolPose& pose, Random& random) {
  const std::size_t which = std::size_t(random() % tool.pieces.size());
  const Spot p = profile_point(tool.pieces[which], random);
  const double a = in(random, 0, 2 * std::numbers::pi);
  const Vec3 u = pose.axis;
  const Vec3 e = normalized(std::abs(u.x) < 0.6 ? cross(u, {1, 0, 0}) : cross(u, {0, 1, 0}));
  const Vec3 f = cross(u, e);
  return pose.tip_mm + u * p.height + (e * std::cos(a) + f * std::sin(a)) * p.radial;
}

std::string text_of(Vec3 v) {
  char text[100];
  std::snprintf(text, sizeof text, "{%.17g, %.17g, %.17g}", v.x, v.y, v.z);
  return text;
}

}  // namespace

std::vector<NamedTool> every_tool(double scale) {
  const auto shaped = [](const char* name, const ToolShape& shape) {
    return NamedTool{name, make_tool(shape).value()};
  };
  const double s = scale;
  return {
      shaped("ball", BallShape{10 * s, 50 * s}),
      shaped("flat", FlatShape{10 * s, 50 * s}),
      shaped("taper", TaperShape{4 * s, 12, 40 * s}),
      shaped("taper_ball", TaperShape{6 * s, 8, 40 * s, TaperTip::kBall}),
      shaped("cone_end", ConeEndShape{10 * s, 90, 50 * s}),
      shaped("bull_nose", BullNoseShape{10 * s, 2 * s, 50 * s}),
      shaped("apt", AptShape{10 * s, 1.5 * s, 3.630717035815369 * s, 2.0250053615596113 * s, 8, 6,
                             40 * s}),
      shaped("barrel",
             ProfileShape{{ProfilePoint{2.5 * s, 0}, ProfileArc{{2.5 * s, 24 * s}, 30 * s}}}),
      shaped("lollipop", ProfileShape{{ProfilePoint{0, 0}, ProfileArc{{1.5 * s, 7.708 * s}, 4 * s},
                                       ProfilePoint{1.5 * s, 40 * s}}}),
      shaped("t_slot",
             ProfileShape{{ProfilePoint{0, 0}, ProfilePoint{6 * s, 0}, ProfilePoint{6 * s, 3 * s},
                           ProfilePoint{2 * s, 3 * s}, ProfilePoint{2 * s, 40 * s}}}),
      shaped("dovetail", ProfileShape{{ProfilePoint{6 * s, 0}, ProfilePoint{3 * s, 6 * s},
                                       ProfilePoint{3 * s, 40 * s}}})};
}

Carving::Carving(SculptureSettings settings, const Tool& tool)
    : sculpture_(Sculpture::create(std::move(settings)).value()), tool_(tool) {
  sculpture_.apply(DefineTool{1, tool}).value();
}

MotionResult Carving::move(const ToolPose& from, const ToolPose& to) {
  const auto moved = sculpture_.apply(MoveTool{1, from, to, 0.01});
  if (!moved) {
    ADD_FAILURE() << "rejected: " << moved.error().reason;
    return {};
  }
  sweeps_.emplace_back(tool_, from, to);
  return *moved;
}

double Carving::rounding_mm() const {
  const DexelGrid& g = sculpture_.grid();
  const double farthest =
      std::max({std::abs(g.x_mm(0)), std::abs(g.x_mm(g.columns_x)), std::abs(g.y_mm(0)),
                std::abs(g.y_mm(g.columns_y)), std::abs(g.origin_mm.z), 10.0});
  // Squares of coordinates lose half of a double's digits only where rays graze a surface. Measured
  // off the surface, a few units in the last place of the coordinates remain.
  return 0.51 * g.z_quantum_mm + 1e-9 + 1e-12 * farthest;
}

double Carving::outside(Vec3 point, double interest_mm) const {
  double best = std::numeric_limits<double>::infinity();
  for (const TrueSweep& sweep : sweeps_) best = std::min(best, sweep.outside(point, interest_mm));
  return best;
}

double Carving::rms_mm() const {
  return ends_judged_ == 0 ? 0 : std::sqrt(squares_mm2_ / double(ends_judged_));
}

void Carving::note(double error, double& worst, Vec3 at, const char* what) {
  if (!(error > worst)) return;
  worst = error;
  worst_place_ = std::string(what) + " at " + text_of(at);
}

double Carving::column_error(const DexelSnapshot& snapshot, std::int32_t i, std::int32_t j,
                             double interest_mm) {
  const DexelGrid& g = snapshot.grid();
  const std::vector<Dexel> solid = column_of(snapshot, i, j);
  double worst = 0;
  const auto at = [&](double depth) {
    return from_frame(g.axis, {g.x_mm(i), g.y_mm(j), g.origin_mm.z + depth * g.z_quantum_mm});
  };
  const auto within = [&](std::int32_t bottom, std::int32_t top, bool is_solid) {
    for (const double share : {0.01, 0.3, 0.5, 0.7, 0.99}) {
      const Vec3 p = at(bottom + share * (top - bottom));
      const double d = outside(p, interest_mm);
      if (!is_solid) overcut_mm_ = std::max(overcut_mm_, std::min(d, interest_mm));
      note(std::min(is_solid ? -d : d, interest_mm), worst, p, is_solid ? "left" : "removed");
    }
  };
  const auto end = [&](std::int32_t depth) {
    if (depth == 0 || depth == g.height_quanta) return;
    const Vec3 p = at(depth);
    const double distance = outside(p, interest_mm);
    overcut_mm_ = std::max(overcut_mm_, std::min(distance, interest_mm));
    const double off = std::min(std::abs(distance), interest_mm);
    ++ends_judged_;
    squares_mm2_ += off * off;
    note(off, worst, p, "end");
    const double deep = std::max(2 * sculpture_.settings().tolerance_mm, 20 * rounding_mm());
    for (const TrueSweep& sweep : sweeps_) {
      if (sweep.well_inside(p, deep)) note(std::min(deep, interest_mm), worst, p, "inner end");
    }
  };
  std::int32_t below = 0;
  for (const Dexel& d : solid) {
    if (below < d.bottom) within(below, d.bottom, false);
    within(d.bottom, d.top, true);
    end(d.bottom);
    end(d.top);
    below = d.top;
  }
  if (below < g.height_quanta) within(below, g.height_quanta, false);
  return worst;
}

double Carving::error_mm(int columns, double interest_mm, unsigned seed) {
  double worst = 0;
  std::string place;
  for (const RayAxis axis : {RayAxis::kZ, RayAxis::kX, RayAxis::kY}) {
    if (!sculpture_.has_field(axis)) continue;
    const double e = field_error(sculpture_.snapshot(axis), columns, interest_mm, seed);
    if (e > worst) worst = e, place = worst_place_;
  }
  worst_place_ = place;
  return worst;
}

double Carving::field_error(const DexelSnapshot& snapshot, int columns, double interest_mm,
                            unsigned seed) {
  Random random(seed);
  const DexelGrid& g = snapshot.grid();
  double worst = 0;
  std::string place;
  const auto judge = [&](double i, double j) {
    const double e = column_error(snapshot, std::int32_t(i), std::int32_t(j), interest_mm);
    if (e > worst) worst = e, place = worst_place_;
  };
  for (const TrueSweep& sweep : sweeps_) {
    int found = 0;
    for (int draw = 0; draw < 30 * columns && found < columns; ++draw) {
      const double share = draw % 5 == 0 ? double(draw / 5 % 2) : in(random, 0, 1);
      const Vec3 p = to_frame(g.axis, surface_point(tool_, sweep.at(share), random));
      const bool in_height = p.z > g.origin_mm.z && p.z < g.z_mm(g.height_quanta);
      const double i = std::floor((p.x - g.origin_mm.x) / g.pitch_mm) + double(random() % 3) - 1;
      const double j = std::floor((p.y - g.origin_mm.y) / g.pitch_mm) + double(random() % 3) - 1;
      const bool in_grid = i >= 0 && j >= 0 && i < g.columns_x && j < g.columns_y;
      if (!in_grid || (!in_height && draw % 8 != 0)) continue;
      ++found;
      judge(i, j);
    }
    // The surface of a tool much larger than the block seldom intersects it: use any column.
    const bool few = double(g.columns_x) * g.columns_y < 1e4;
    for (; few && found < columns; ++found) {
      judge(std::floor(in(random, 0, g.columns_x)), std::floor(in(random, 0, g.columns_y)));
    }
  }
  worst_place_ = place;
  return worst;
}

std::string Carving::motions_text() const {
  std::string text;
  for (const TrueSweep& sweep : sweeps_) {
    const ToolPose a = sweep.at(0), b = sweep.at(1);
    text += "\n  tip " + text_of(a.tip_mm) + " to " + text_of(b.tip_mm) + ", axis " +
            text_of(a.axis) + " to " + text_of(b.axis);
  }
  return text;
}

void Carving::expect_within_tolerance(const std::string& what, int columns, unsigned seed) {
  const double tolerance = sculpture_.settings().tolerance_mm;
  const double allowed = tolerance + rounding_mm();
  const double error = error_mm(columns, 10 * allowed + 0.1, seed);
  EXPECT_LE(error, allowed) << what << ": " << worst_place_ << motions_text();
}

int effort() {
  const char* text = std::getenv("KERF_EFFORT");
  return text == nullptr ? 1 : std::max(1, std::atoi(text));
}

ToolPose leaning(Vec3 tip, double lean_rad, double azimuth_rad) {
  return {tip,
          {std::sin(lean_rad) * std::cos(azimuth_rad), std::sin(lean_rad) * std::sin(azimuth_rad),
           std::cos(lean_rad)}};
}

Vec3 turned(Vec3 axis, Vec3 about, double turn_rad) {
  const Vec3 u = normalized(axis);
  const Vec3 side = normalized(cross(about, u));
  return normalized(u * std::cos(turn_rad) + side * std::sin(turn_rad));
}

SculptureSettings block(double width_mm, double height_mm, double pitch_mm, double tolerance_mm,
                        Vec3 top_center) {
  SculptureSettings s;
  const double half = width_mm / 2;
  s.stock = BoxStock{{top_center.x - half, top_center.y - half, top_center.z - height_mm},
                     {top_center.x + half, top_center.y + half, top_center.z}};
  s.pitch_mm = pitch_mm;
  s.tolerance_mm = tolerance_mm;
  return s;
}

std::vector<Dexel> column_of(const DexelSnapshot& snapshot, std::int32_t i, std::int32_t j) {
  std::vector<Dexel> scratch;
  const auto column = snapshot.column(i, j, scratch);
  return {column.begin(), column.end()};
}

void expect_sound(const DexelSnapshot& snapshot, const std::string& what) {
  const DexelGrid& g = snapshot.grid();
  for (std::int32_t j = 0; j < g.columns_y; ++j) {
    for (std::int32_t i = 0; i < g.columns_x; ++i) {
      std::int32_t below = -1;
      for (const Dexel& d : column_of(snapshot, i, j)) {
        ASSERT_GT(d.bottom, below) << what << " column " << i << ' ' << j;
        ASSERT_LT(d.bottom, d.top) << what << " column " << i << ' ' << j;
        below = d.top;
      }
      ASSERT_LE(below, g.height_quanta) << what << " column " << i << ' ' << j;
    }
  }
}

}  // namespace kerf::test
