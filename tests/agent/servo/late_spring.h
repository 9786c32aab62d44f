// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <utility>

namespace kerf::agent {

inline constexpr double kTickS = 1e-3;

/// A loop of 1 kHz whose wrench acts a latency after the pose, and whose velocity is low-pass
/// filtered.
struct LateLoop {
  double latency_s, cutoff_hz;
  double filter_s() const { return 1 / (2 * std::numbers::pi * cutoff_hz); }
};

/// Returns the ratio of the motion of a mass on a rendered spring and damper after 0.5 s to that
/// after 0.1 s: more than 1 if the oscillation grows. SI units.
inline double growth(double mass, double stiffness, double damping, const LateLoop& loop) {
  constexpr int kSteps = 8, kTicks = 600, kEarly = 100, kLate = 500;
  const double part = kTickS / (loop.filter_s() + kTickS);
  std::deque<std::pair<double, double>> written;
  double x = 1e-3, v = 0, filtered = 0, last = x, acting = 0, time = 0, early = 0, late = 0;
  for (int tick = 0; tick < kTicks; ++tick) {
    filtered += ((x - last) / kTickS - filtered) * part;
    last = x;
    written.emplace_back(time + loop.latency_s, -stiffness * x - damping * filtered);
    for (int n = 0; n < kSteps; ++n, time += kTickS / kSteps) {
      while (!written.empty() && written.front().first <= time + 1e-9) {
        acting = written.front().second;
        written.pop_front();
      }
      v += acting / mass * kTickS / kSteps;
      x += v * kTickS / kSteps;
      const double energy = stiffness * x * x + mass * v * v;
      if (tick >= kEarly && tick < 2 * kEarly) early = std::max(early, energy);
      if (tick >= kLate) late = std::max(late, energy);
    }
  }
  return std::isfinite(late) ? late / early : 1e9;
}

/// Returns the greatest growth over masses from `mass` to 1000 times it.
inline double worst_growth(double mass, double stiffness, double damping, const LateLoop& loop) {
  double worst = 0;
  for (const double times : {1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 30.0, 100.0, 1000.0})
    worst = std::max(worst, growth(times * mass, stiffness, damping, loop));
  return worst;
}

}  // namespace kerf::agent
