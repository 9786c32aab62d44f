// SPDX-License-Identifier: Apache-2.0
#include "kernel/sculpture_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/dexel/mesh_stock.h"
#include "kernel/dexel/stock_column.h"
#include "kernel/force/collision.h"

namespace kerf {
namespace {

bool in_range(Vec3 v) {
  return std::abs(v.x) <= kCoordinateMaxMm && std::abs(v.y) <= kCoordinateMaxMm &&
         std::abs(v.z) <= kCoordinateMaxMm;
}

Check check_box(Vec3 lo, Vec3 hi) {
  using enum SculptureErrorCode;
  if (!is_finite(lo) || !is_finite(hi)) return reject(kBadStock, "the stock must be finite");
  if (!in_range(lo) || !in_range(hi))
    return reject(kBadStock, "the stock must lie within 1e6 mm of the origin in x, y and z");
  if (!(lo.x < hi.x && lo.y < hi.y && lo.z < hi.z)) {
    return reject(kBadStock, "the stock is empty: every minimum must be less than its maximum");
  }
  const Vec3 size = hi - lo;
  if (!(std::min({size.x, size.y, size.z}) >= kStockSizeMinMm)) {
    return reject(kBadStock, "every side of the stock must be at least 0.0001 mm long");
  }
  return {};
}

Check check_stock(const StockShape& stock) {
  if (const auto* box = std::get_if<BoxStock>(&stock)) return check_box(box->min_mm, box->max_mm);
  const auto& c = std::get<CylinderStock>(stock);
  const double r = c.radius_mm;
  return check_box({c.center_x_mm - r, c.center_y_mm - r, c.min_z_mm},
                   {c.center_x_mm + r, c.center_y_mm + r, c.max_z_mm});
}

Check check_milling(const MillingSettings& m) {
  using enum SculptureErrorCode;
  const auto within = [](double v, double most) { return v >= 0 && v <= most; };
  const auto usable = [&](const EdgeCoefficients& k, double most) {
    return within(k.tangential, most) && within(k.radial, most) && within(k.axial, most);
  };
  if (!(m.spindle_rpm >= kSpindleMinRpm && m.spindle_rpm <= kSpindleMaxRpm))
    return reject(kBadForce, "spindle_rpm must be from 1 to 1e6");
  if (m.teeth < 1 || m.teeth > kTeethMax) return reject(kBadForce, "teeth must be from 1 to 100");
  if (!within(m.helix_deg, kHelixMaxDeg))
    return reject(kBadForce, "helix_deg must be from 0 to 80");
  if (!usable(m.chip_exponents, kChipExponentMax))
    return reject(kBadForce, "every chip exponent must be from 0 to 0.9");
  if (!usable(m.cut_n_per_mm2, kForceCoefficientMax) ||
      !usable(m.edge_n_per_mm, kForceCoefficientMax) ||
      !within(m.feed_per_tooth_mm, kFeedPerToothMaxMm) || !within(m.runout_mm, kRunoutMaxMm) ||
      !within(m.ripple_hz, kForceCoefficientMax) || !within(m.scale, 1))
    return reject(kBadForce, "every coefficient of milling must be from 0 to its maximum");
  return {};
}

double longest_side_mm(const StockShape& stock) {
  const BoxStock box = stock_bounds(stock);
  const Vec3 size = box.max_mm - box.min_mm;
  return std::max({size.x, size.y, size.z});
}

/// Returns whether a component is denormal. Such numbers have lost precision, and no valid pose has
/// one.
bool has_denormal(Vec3 v) {
  return std::fpclassify(v.x) == FP_SUBNORMAL || std::fpclassify(v.y) == FP_SUBNORMAL ||
         std::fpclassify(v.z) == FP_SUBNORMAL;
}

}  // namespace

Check reject(SculptureErrorCode code, std::string reason) {
  return std::unexpected(SculptureError{code, std::move(reason)});
}

Check check_settings(const SculptureSettings& s) {
  using enum SculptureErrorCode;
  if (auto c = check_stock(s.stock); !c) return c;
  if (!(s.pitch_mm >= 0.0001 && s.pitch_mm <= 1000)) {
    return reject(kBadPitch, "pitch_mm must be between 0.0001 and 1000");
  }
  if (!(s.tolerance_mm >= 0.000001 && s.tolerance_mm <= 100)) {
    return reject(kBadTolerance, "tolerance_mm must be between 0.000001 and 100");
  }
  if (s.keep_normals && longest_side_mm(s.stock) > double(kSurfacePitchesMax) * s.pitch_mm) {
    return reject(kTooManyColumns,
                  "a side of the stock is longer than 2^20 pitches, too long for a surface model; "
                  "increase pitch_mm");
  }
  for (const RayAxis axis : axes_of(s.rays)) {
    if (columns_in_field(s.stock, s.pitch_mm, axis) > double(kColumnsMax)) {
      return reject(kTooManyColumns, "the stock needs more than 2^36 columns; increase pitch_mm");
    }
    if (s.stock_mesh && columns_in_field(s.stock, s.pitch_mm, axis) > double(kMeshColumnsMax)) {
      return reject(kTooManyColumns,
                    "a stock from a mesh may have at most 2^28 columns; increase pitch_mm");
    }
  }
  const ForceSettings& f = s.force;
  const auto usable = [](double v) { return std::isfinite(v) && v >= 0; };
  if (!usable(f.specific_force_n_per_mm2) || !usable(f.drr_n_s_per_mm3) || !usable(f.pivot_mm) ||
      !usable(f.contact_stiffness_n_per_mm)) {
    return reject(kBadForce, "every force setting must be finite and >= 0");
  }
  if (f.law == ForceLaw::kMechanistic) {
    if (auto c = check_milling(f.milling); !c) return c;
  }
  for (std::size_t i = 0; i < s.obstacles.size(); ++i) {
    const std::string fault = check_obstacle(s.obstacles[i]);
    if (!fault.empty()) {
      return reject(kBadObstacle, "obstacle " + std::to_string(i) + ": " + fault);
    }
  }
  return {};
}

Check check_pose(const char* which, const ToolPose& pose) {
  using enum SculptureErrorCode;
  const std::string name = which;
  if (!is_finite(pose.tip_mm) || !is_finite(pose.axis)) {
    return reject(kNotFinite, name + " pose must be finite");
  }
  if (!in_range(pose.tip_mm)) {
    return reject(kOutOfRange, name + " tip must lie within 1e6 mm of the origin in x, y and z");
  }
  const double n = length(pose.axis);
  if (!(n >= 0.5 && n <= 2)) {
    return reject(kBadAxis,
                  name + " axis must be a unit vector (lengths from 0.5 to 2 are accepted)");
  }
  if (has_denormal(pose.tip_mm) || has_denormal(pose.axis)) {
    return reject(kNotFinite, name + " pose must not contain denormal numbers");
  }
  return {};
}

}  // namespace kerf
