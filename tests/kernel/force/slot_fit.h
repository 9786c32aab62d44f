// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernel/force/milling_settings.h"
#include "kernel/math/vec3.h"

namespace kerf::test {

/// Mean force on a tool in a slot: x along the feed, y to its left, z up.
struct SlotMean {
  double depth_mm, feed_per_tooth_mm;
  Vec3 force_n;
};

/// Kienzle's coefficients and exponents.
struct SlotFit {
  EdgeCoefficients cut_n_per_mm2, exponents;
};

/// Fits Kienzle's law to mean forces in slots, with an exponent for each direction, in closed form:
/// least squares of the errors relative to the measured resultants, exponents in steps of 0.05. The
/// edge is an arc of the radius `corner_mm` (that of a ball or of a bull nose, or 0), and straight
/// above it.
class SlotFitter {
 public:
  SlotFitter(int teeth, double corner_mm) : teeth_(teeth), corner_mm_(corner_mm) {}

  SlotFit fit(const std::vector<SlotMean>& means) const {
    SlotFit best;
    double least_y = 1e300, least_xz = 1e300;
    for (const double t : exponents()) {
      // The tangential force alone is across the feed.
      double square = 0, product = 0, y2 = 0;
      for (const SlotMean& m : means) {
        const double w = 1 / dot(m.force_n, m.force_n), y = of(m, t).y;
        square += w * y * y;
        product += w * y * m.force_n.y;
        y2 += w * m.force_n.y * m.force_n.y;
      }
      if (y2 - product * product / square >= least_y) continue;
      least_y = y2 - product * product / square;
      best.cut_n_per_mm2.tangential = product / square;
      best.exponents.tangential = t;
    }
    for (const double r : exponents()) {
      for (const double a : exponents()) fit_rest(means, r, a, least_xz, best);
    }
    return best;
  }

 private:
  static std::vector<double> exponents() {
    std::vector<double> all;
    for (int i = 0; i <= 18; ++i) all.push_back(0.05 * i);
    return all;
  }

  /// The forces of three coefficients of 1 N/mm².
  struct Unit {
    double y;              ///< tangential
    Vec3 radial, axial{};  ///< without y
  };

  Unit of(const SlotMean& m, double exponent) const {
    const double p = 1 - exponent;
    const auto turned = [](double power) {  // the integral of sin^power over half a turn
      return std::sqrt(M_PI) * std::tgamma((power + 1) / 2) / std::tgamma(power / 2 + 1);
    };
    constexpr int kParts = 200;
    const double arc_mm = std::min(m.depth_mm, corner_mm_);
    const double end = corner_mm_ > 0 ? std::acos(1 - arc_mm / corner_mm_) : 0;
    double sum = m.depth_mm - arc_mm, sines = sum, cosines = 0;
    for (int i = 0; i < kParts; ++i) {
      const double angle = end * (i + 0.5) / kParts, sine = std::sin(angle);
      const double chips = std::pow(sine, p) * corner_mm_ * end / kParts;
      sum += chips;
      sines += chips * sine;
      cosines += chips * std::cos(angle);
    }
    const double scale = teeth_ / (2 * M_PI) * std::pow(m.feed_per_tooth_mm, p);
    const double side = scale * turned(p + 1), up = scale * turned(p);
    return {side * sum, {-side * sines, 0, up * cosines}, {-side * cosines, 0, -up * sines}};
  }

  void fit_rest(const std::vector<SlotMean>& means, double r, double a, double& least,
                SlotFit& best) const {
    double rr = 0, ra = 0, aa = 0, rf = 0, af = 0, ff = 0;
    for (const SlotMean& m : means) {
      const double w = 1 / dot(m.force_n, m.force_n);
      const Vec3 radial = of(m, r).radial, axial = of(m, a).axial;
      const Vec3 f{m.force_n.x, 0, m.force_n.z};
      rr += w * dot(radial, radial);
      ra += w * dot(radial, axial);
      aa += w * dot(axial, axial);
      rf += w * dot(radial, f);
      af += w * dot(axial, f);
      ff += w * dot(f, f);
    }
    const double det = rr * aa - ra * ra;
    const double kr = (rf * aa - af * ra) / det, ka = (af * rr - rf * ra) / det;
    const double error = ff - kr * rf - ka * af;
    if (!(det > 0) || kr < 0 || ka < 0 || error >= least) return;
    least = error;
    best.cut_n_per_mm2.radial = kr;
    best.cut_n_per_mm2.axial = ka;
    best.exponents.radial = r;
    best.exponents.axial = a;
  }

  int teeth_;
  double corner_mm_;
};

}  // namespace kerf::test
