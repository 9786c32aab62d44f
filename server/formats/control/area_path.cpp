// SPDX-License-Identifier: Apache-2.0
#include "server/formats/control/area_path.h"

#include <algorithm>
#include <cmath>

#include "server/formats/number_text.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr double kAreaPointMm = 1e-6;
constexpr std::size_t kLoopsMax = 2000;
constexpr int kLevelsMax = 20'000;
/// Least distance of loops in radii of the tool.
constexpr double kStepMin = 0.01;
/// Greatest distance of loops in radii of the tool. A corner between two loops is half the
/// diagonal, 0.71 of this, from both, so nothing remains.
constexpr double kStepMax = 1.4;
/// Distance from the blank at which the path of a stud begins.
constexpr double kBesideMm = 2;

std::unexpected<std::string> too_many() {
  return std::unexpected<std::string>("the tool is too small: more than 2000 loops were needed");
}

std::unexpected<std::string> too_large(double tool_radius, const char* where) {
  return std::unexpected<std::string>("the tool of radius " + decimal_text(tool_radius, 6) +
                                      " mm does not fit into " + where);
}

void straight(AreaPath& path, double x, double y) {
  if (!path.empty() && std::hypot(path.back().x - x, path.back().y - y) < kAreaPointMm) return;
  path.push_back({.x = x, .y = y});
}

void arc(AreaPath& path, double x, double y, int turns, double center_x, double center_y) {
  if (std::hypot(center_x - x, center_y - y) < kAreaPointMm) return straight(path, x, y);
  path.push_back({.x = x, .y = y, .turns = turns, .center_x = center_x, .center_y = center_y});
}

// Once about a rounded rectangle from the middle of its lower side, counterclockwise or not.
void loop(AreaPath& path, double half_x, double half_y, double corner, bool clockwise) {
  const double s = clockwise ? -1 : 1, x = half_x - corner, y = half_y - corner;
  const int turns = clockwise ? -1 : 1;
  straight(path, 0, -half_y);
  straight(path, s * x, -half_y);
  arc(path, s * half_x, -y, turns, s * x, -y);
  straight(path, s * half_x, y);
  arc(path, s * x, half_y, turns, s * x, y);
  straight(path, -s * x, half_y);
  arc(path, -s * half_x, y, turns, -s * x, y);
  straight(path, -s * half_x, -y);
  arc(path, -s * x, -half_y, turns, -s * x, -y);
  straight(path, 0, -half_y);
}

// Distances of the loops from the wall, the smallest last. The first loop leaves nothing inside.
std::vector<double> insets(double narrow_half, double tool_radius, double step) {
  const double apart = std::clamp(step, tool_radius * kStepMin, kStepMax * tool_radius);
  std::vector<double> at{tool_radius};
  while (narrow_half - at.back() > tool_radius * (1 - 1e-9) && at.size() < kLoopsMax)
    at.push_back(std::min(at.back() + apart, narrow_half));
  std::ranges::reverse(at);
  return at;
}

bool is_usable(double tool_radius) { return tool_radius > 0 && std::isfinite(tool_radius); }

double beyond(const RoundedRectangle& stud, double x, double y) {
  const double dx = std::max(0.0, x - (stud.length / 2 - stud.corner));
  const double dy = std::max(0.0, y - (stud.width / 2 - stud.corner));
  return std::hypot(dx, dy) - stud.corner;
}

}  // namespace

AreaResult clear_pocket(const RoundedRectangle& pocket, double tool_radius, double step) {
  const double half_x = pocket.length / 2, half_y = pocket.width / 2;
  const double narrow = std::min(half_x, half_y);
  if (!is_usable(tool_radius) || !(narrow >= tool_radius - kAreaPointMm))
    return too_large(tool_radius, "the pocket");
  const double corner = std::clamp(pocket.corner, std::min(tool_radius, narrow), narrow);
  AreaPath path;
  const std::vector<double> loops = insets(narrow, tool_radius, step);
  if (loops.size() >= kLoopsMax) return too_many();
  for (const double inset : loops) {
    const double x = std::max(0.0, half_x - inset), y = std::max(0.0, half_y - inset);
    loop(path, x, y, std::clamp(corner - inset, 0.0, std::min(x, y)), false);
  }
  return path;
}

AreaResult mill_stud(const RoundedRectangle& stud, const RoundedRectangle& blank,
                     double tool_radius, double step) {
  if (!is_usable(tool_radius) || !(stud.length > 0 && stud.width > 0))
    return std::unexpected("the stud and the tool must have a size");
  if (blank.length < stud.length - kAreaPointMm || blank.width < stud.width - kAreaPointMm)
    return std::unexpected("the blank is smaller than the stud");
  // The points of the blank farthest from the stud are in its corners.
  const double inward = blank.corner * (1 - std::sqrt(0.5));
  const double out =
      std::max({beyond(stud, blank.length / 2 - inward, blank.width / 2 - inward),
                beyond(stud, blank.length / 2, 0), beyond(stud, 0, blank.width / 2), 0.0});
  const double apart = std::clamp(step, tool_radius * kStepMin, kStepMax * tool_radius);
  std::vector<double> offsets{tool_radius};
  while (offsets.back() + tool_radius < out && offsets.size() < kLoopsMax)
    offsets.push_back(std::min(offsets.back() + apart, out));
  if (offsets.size() >= kLoopsMax) return too_many();
  AreaPath path;
  straight(path, 0, -(stud.width / 2 + out + tool_radius + kBesideMm));
  for (std::size_t i = offsets.size(); i-- > 0;)
    loop(path, stud.length / 2 + offsets[i], stud.width / 2 + offsets[i], stud.corner + offsets[i],
         true);
  return path;
}

AreaResult clear_arc_slot(const ArcSlot& slot, double tool_radius, double step) {
  if (!is_usable(tool_radius) || slot.width / 2 < tool_radius - kAreaPointMm)
    return too_large(tool_radius, "the slot");
  if (!(slot.radius > slot.width / 2) || !(std::abs(slot.sweep_deg) <= 360))
    return std::unexpected("the slot's width must be below its radius, and its angle at most 360");
  const double from = kRadPerDeg * std::min(slot.first_deg, slot.first_deg + slot.sweep_deg);
  const double to = from + kRadPerDeg * std::abs(slot.sweep_deg);
  AreaPath path;
  const std::vector<double> loops = insets(slot.width / 2, tool_radius, step);
  if (loops.size() >= kLoopsMax) return too_many();
  for (const double inset : loops) {
    const double half = std::max(0.0, slot.width / 2 - inset);
    const auto go = [&](double radius, double angle, int turns, double center_radius) {
      const double x = radius * std::cos(angle), y = radius * std::sin(angle);
      const double cx = center_radius * std::cos(angle), cy = center_radius * std::sin(angle);
      if (turns == 0) return straight(path, x, y);
      arc(path, x, y, turns, cx, cy);
    };
    go(slot.radius + half, from, 0, 0);
    if (to > from) go(slot.radius + half, to, 1, 0);
    go(slot.radius - half, to, 1, slot.radius);
    if (to > from) go(slot.radius - half, from, -1, 0);
    go(slot.radius + half, from, 1, slot.radius);
  }
  return path;
}

AreaResult face(double length, double width, bool along_x, double tool_radius, double step) {
  const double across = std::abs(along_x ? width : length);
  if (!is_usable(tool_radius) || !(step > 0) || !(across / step < kLoopsMax))
    return std::unexpected("the width of a stroke must be above 0");
  const double apart = std::min(step, 2 * tool_radius);
  const auto strokes = std::max(1, static_cast<int>(std::ceil(across / apart - 1e-9)));
  AreaPath path;
  for (int i = 0; i < strokes; ++i) {
    // The first and the last stroke reach the edge with the tool's side.
    const double share = (i + 0.5) / strokes;
    const double begin = i % 2 == 0 ? 0 : 1;
    for (const double end : {begin, 1 - begin}) {
      if (along_x) {
        straight(path, length * end, width * share);
      } else {
        straight(path, length * share, width * end);
      }
    }
  }
  return path;
}

AreaPath last_loop(const AreaPath& path) {
  for (std::size_t from = path.empty() ? 0 : path.size() - 1; from > 0; --from) {
    const AreaMove& start = path[from - 1];
    if (std::hypot(start.x - path.back().x, start.y - path.back().y) < kAreaPointMm) {
      AreaPath loop(path.begin() + std::ptrdiff_t(from) - 1, path.end());
      loop.front().turns = 0;
      return loop;
    }
  }
  return path;
}

AreaPath placed(AreaPath path, double x, double y, double turn_deg) {
  const double c = std::cos(kRadPerDeg * turn_deg), s = std::sin(kRadPerDeg * turn_deg);
  for (AreaMove& move : path) {
    const AreaMove old = move;
    move.x = x + c * old.x - s * old.y;
    move.y = y + s * old.x + c * old.y;
    move.center_x = x + c * old.center_x - s * old.center_y;
    move.center_y = y + s * old.center_x + c * old.center_y;
  }
  return path;
}

std::vector<double> pass_levels(double top, double bottom, double infeed) {
  const double depth = top - bottom;
  const int count = infeed > 0 && depth > infeed && depth / infeed < kLevelsMax
                        ? static_cast<int>(std::ceil(depth / infeed - 1e-9))
                        : 1;
  std::vector<double> levels;
  for (int i = 1; i < count; ++i) levels.push_back(top - depth * i / count);
  levels.push_back(bottom);
  return levels;
}

}  // namespace kerf
