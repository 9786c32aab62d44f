// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/doctor/motion_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace kerf::agent {
namespace {

constexpr double kTickS = 1e-3;
constexpr double kCutoffHz = 30;
constexpr int kPasses = 4;  ///< passes of a first-order low-pass filter
constexpr double kMostLatencyS = 0.015, kLatencyStepS = 1e-4;
constexpr std::size_t kTerms = 5;  ///< mass, viscous, friction, stiffness, constant
constexpr std::size_t kSettling = 100;
constexpr double kMostError = 0.5;

using Signal = std::vector<double>;

Signal filtered(Signal signal) {
  const double part = 1 - std::exp(-2 * std::numbers::pi * kCutoffHz * kTickS);
  for (int pass = 0; pass < kPasses; ++pass) {
    double state = signal.empty() ? 0 : signal.front();
    for (double& value : signal) value = state += (value - state) * part;
  }
  return signal;
}

/// The terms of the equation of motion, low-passed.
struct Terms {
  std::array<Signal, kTerms> of;
  Signal effort;  ///< mean over the two adjacent ticks
};

Terms terms_of(const std::vector<MotionRecord>& motion) {
  const std::size_t n = motion.size();
  Signal x(n), effort(n);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = motion[i].position - motion.front().position;
    effort[i] = (motion[i].effort + motion[i - (i > 0 ? 1 : 0)].effort) / 2;
  }
  const Signal smooth = filtered(x);
  Signal speed(n), change(n), sign(n);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    speed[i] = (smooth[i + 1] - smooth[i - 1]) / (2 * kTickS);
    change[i] = (smooth[i + 1] - 2 * smooth[i] + smooth[i - 1]) / (kTickS * kTickS);
  }
  // Friction depends on the sign of the unfiltered velocity. The result is filtered like the other
  // terms, so that all have the same delay.
  double fastest = 0;
  for (const double v : speed) fastest = std::max(fastest, std::abs(v));
  Signal raw(n);
  constexpr std::size_t kSpan = 4;
  for (std::size_t i = kSpan; i + kSpan < n; ++i) {
    const double v = (x[i + kSpan] - x[i - kSpan]) / (2 * kSpan * kTickS);
    raw[i] = std::clamp(v / (0.05 * fastest + 1e-12), -1.0, 1.0);
  }
  return {.of = {change, speed, filtered(raw), smooth, Signal(n, 1.0)}, .effort = filtered(effort)};
}

struct Solution {
  std::array<double, kTerms> factors{};
  double error = 0;
};

/// Solves the normal equations by elimination. Returns nullopt if they are singular.
std::optional<std::array<double, kTerms>> solved(
    std::array<std::array<double, kTerms + 1>, kTerms> a) {
  for (std::size_t c = 0; c < kTerms; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c + 1; r < kTerms; ++r)
      if (std::abs(a[r][c]) > std::abs(a[pivot][c])) pivot = r;
    if (!(std::abs(a[pivot][c]) > 0)) return std::nullopt;
    std::swap(a[c], a[pivot]);
    for (std::size_t r = 0; r < kTerms; ++r) {
      if (r == c) continue;
      const double factor = a[r][c] / a[c][c];
      for (std::size_t k = c; k <= kTerms; ++k) a[r][k] -= factor * a[c][k];
    }
  }
  std::array<double, kTerms> factors{};
  for (std::size_t r = 0; r < kTerms; ++r) factors[r] = a[r][kTerms] / a[r][r];
  return factors;
}

std::optional<Solution> fit_at(const Terms& terms, double latency_s) {
  std::array<std::array<double, kTerms + 1>, kTerms> normal{};
  const double ticks = latency_s / kTickS;
  const auto whole = static_cast<std::size_t>(ticks);
  const double rest = ticks - static_cast<double>(whole);
  const auto effort_at = [&](std::size_t i) {
    return terms.effort[i - whole] * (1 - rest) + terms.effort[i - whole - 1] * rest;
  };
  const std::size_t from = kSettling + whole + 1, to = terms.effort.size() - 1;
  double mean = 0, all = 0, explained = 0;
  for (std::size_t i = from; i < to; ++i) {
    const double effort = effort_at(i);
    mean += effort / static_cast<double>(to - from);
    for (std::size_t r = 0; r < kTerms; ++r) {
      for (std::size_t c = 0; c < kTerms; ++c) normal[r][c] += terms.of[r][i] * terms.of[c][i];
      normal[r][kTerms] += terms.of[r][i] * effort;
    }
  }
  const auto factors = solved(normal);
  if (!factors) return std::nullopt;
  for (std::size_t i = from; i < to; ++i) {
    double sum = 0;
    for (std::size_t r = 0; r < kTerms; ++r) sum += (*factors)[r] * terms.of[r][i];
    const double effort = effort_at(i);
    explained += (effort - sum) * (effort - sum);
    all += (effort - mean) * (effort - mean);
  }
  return Solution{*factors, all > 0 ? std::sqrt(explained / all) : 1};
}

}  // namespace

double quantum_of(const std::vector<MotionRecord>& motion) {
  Signal steps;
  for (std::size_t i = 1; i < motion.size(); ++i)
    steps.push_back(std::abs(motion[i].position - motion[i - 1].position));
  constexpr std::size_t kEnough = 20;
  // Normalizing the axis couples its coordinates, so a step of one moves the other slightly. Such
  // small steps do not count.
  constexpr double kUsual = 0.9, kLeast = 0.01;
  std::ranges::sort(steps);
  if (steps.empty()) return 0;
  const double usual = steps[static_cast<std::size_t>(kUsual * static_cast<double>(steps.size()))];
  std::erase_if(steps, [&](double step) { return !(step > kLeast * usual); });
  if (steps.size() < kEnough) return 0;
  const double least = steps[steps.size() / kEnough];
  double sum = 0, counts = 0, near = 0, seen = 0;
  constexpr double kNear = 0.1, kMostCount = 10, kMost = 0.9;
  for (const double step : steps) {
    const double count = std::round(step / least);
    if (count > kMostCount) break;
    ++seen;
    if (count < 1 || std::abs(step / least - count) > kNear) continue;
    ++near;
    sum += step;
    counts += count;
  }
  return near > kMost * seen ? sum / counts : 0;
}

std::expected<MotionFit, std::string> fit_motion(const std::vector<MotionRecord>& motion) {
  constexpr std::size_t kLeastTicks = 1000;
  if (motion.size() < kLeastTicks) return std::unexpected("less than a second was recorded");
  const Terms terms = terms_of(motion);
  std::optional<Solution> best;
  double best_s = 0;
  for (double latency_s = 0; latency_s <= kMostLatencyS; latency_s += kLatencyStepS) {
    const auto next = fit_at(terms, latency_s);
    if (!next || (best && !(next->error < best->error))) continue;
    best = next;
    best_s = latency_s;
  }
  if (!best) return std::unexpected("the device did not move");
  if (!(best->error < kMostError) || !(best->factors[0] > 0))
    return std::unexpected(
        "the motion does not follow from the force: something else moves or blocks the device");
  return MotionFit{.mass = best->factors[0],
                   .viscous = std::max(0.0, best->factors[1]),
                   .friction = std::max(0.0, best->factors[2]),
                   .stiffness = std::max(0.0, best->factors[3]),
                   .latency_s = best_s,
                   .quantum = quantum_of(motion),
                   .error = best->error};
}

}  // namespace kerf::agent
