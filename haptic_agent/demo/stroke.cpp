// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/demo/stroke.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace kerf::demo {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
constexpr double kClearStepMm = 0.5;  // distance between the checked points of the shank
constexpr double kClearMm = 0.02;     // error bound of the map's bilinear interpolation
constexpr Vec3 kUp{0, 0, 1};

// Returns points on the line at most step_mm apart, including its corners.
std::vector<Vec3> resampled(const std::vector<Vec3>& line, double step_mm) {
  std::vector<Vec3> points = {line.front()};
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vec3 segment = line[i] - line[i - 1];
    const int count = static_cast<int>(std::ceil(length(segment) / step_mm));
    for (int k = 1; k <= count; ++k) points.push_back(line[i - 1] + segment * (1.0 * k / count));
  }
  return points;
}

// Averages each direction with its neighbors.
std::vector<Vec3> smoothed(const std::vector<Vec3>& axes, std::size_t reach) {
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    Vec3 sum;
    const std::size_t end = std::min(i + reach + 1, axes.size());
    for (std::size_t k = i < reach ? 0 : i - reach; k < end; ++k) sum = sum + axes[k];
    result.push_back(normalized(sum));
  }
  return result;
}

void append(std::string& text, const char* format, auto... values) {
  char line[160];
  const int size = std::snprintf(line, sizeof line, format, values...);
  text.append(line, static_cast<std::size_t>(size));
}

void append_goto(std::string& text, Vec3 tip, Vec3 axis) {
  append(text, "GOTO/%.4f,%.4f,%.4f,%.6f,%.6f,%.6f\n", tip.x, tip.y, tip.z, axis.x, axis.y, axis.z);
}

}  // namespace

Follower::Follower(const HeightMap& target, BallTool tool, FollowSettings settings)
    : tool_(tool),
      settings_(settings),
      centers_(target.centers_of_ball(tool.radius_mm + settings.allowance_mm)) {}

Vec3 Follower::center(Vec3 at, double level_mm) const {
  return {at.x, at.y, std::max(centers_.at(at.x, at.y) + kClearMm, level_mm + tool_.radius_mm)};
}

Vec3 Follower::preferred_axis(Vec3 center_mm) const {
  const Vec3 normal = centers_.normal(center_mm.x, center_mm.y, 1);
  const double sine = std::sqrt(normal.x * normal.x + normal.y * normal.y);
  if (sine < 1e-9) return kUp;
  const double tilt = std::min(settings_.tilt_share * std::atan2(sine, normal.z),
                               settings_.tilt_max_deg * kRadPerDeg);
  const Vec3 side{normal.x / sine, normal.y / sine, 0};
  return side * std::sin(tilt) + kUp * std::cos(tilt);
}

// The shank has the ball's radius, so it is clear if every point of the axis is a valid center of
// the ball.
bool Follower::is_clear(Vec3 center_mm, Vec3 axis) const {
  for (double s = 0; s < tool_.length_mm; s += kClearStepMm) {
    const Vec3 point = center_mm + axis * s;
    if (point.z > tool_.radius_mm) return true;
    if (point.z < centers_.at(point.x, point.y)) return false;
  }
  return true;
}

Vec3 Follower::clear_axis(Vec3 center_mm, Vec3 axis) const {
  for (double share = 1; share > 0.05; share -= 0.1) {
    const Vec3 leaning = normalized(kUp * (1 - share) + axis * share);
    if (is_clear(center_mm, leaning)) return leaning;
  }
  return kUp;
}

Stroke Follower::along(const std::vector<Vec3>& line, double feed_mm_per_s, double level_mm) const {
  std::vector<Vec3> centers, axes;
  for (const Vec3 at : resampled(line, settings_.step_mm)) {
    centers.push_back(center(at, level_mm));
    axes.push_back(preferred_axis(centers.back()));
  }
  axes = smoothed(axes, static_cast<std::size_t>(settings_.smooth_mm / settings_.step_mm));
  for (std::size_t i = 0; i < axes.size(); ++i) axes[i] = clear_axis(centers[i], axes[i]);
  axes = smoothed(axes, 2);  // spreads the changes by clear_axis over several poses
  Stroke stroke{tool_.id, feed_mm_per_s, {}};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const Vec3 axis = is_clear(centers[i], axes[i]) ? axes[i] : clear_axis(centers[i], axes[i]);
    stroke.poses.push_back({centers[i] - axis * tool_.radius_mm, axis});
  }
  return stroke;
}

std::vector<Stroke> divided(const std::vector<Stroke>& strokes, double seconds) {
  std::vector<Stroke> parts;
  for (const Stroke& stroke : strokes) {
    const double most_mm = seconds * stroke.feed_mm_per_s;
    double length_mm = 0;
    parts.push_back({stroke.tool, stroke.feed_mm_per_s, {stroke.poses.front()}});
    for (std::size_t i = 1; i < stroke.poses.size(); ++i) {
      const DemoPose& from = stroke.poses[i - 1];
      const double step_mm = length(stroke.poses[i].tip_mm - from.tip_mm);
      if (length_mm > 0 && length_mm + step_mm > most_mm) {
        parts.push_back({stroke.tool, stroke.feed_mm_per_s, {from}});
        length_mm = 0;
      }
      parts.back().poses.push_back(stroke.poses[i]);
      length_mm += step_mm;
    }
  }
  return parts;
}

std::string apt_text(const std::string& name, const std::vector<Stroke>& strokes,
                     double retract_mm) {
  std::string text = "PARTNO/" + name + "\nUNITS/MM\nMULTAX/ON\n";
  std::uint32_t loaded = 0;
  for (const Stroke& stroke : strokes) {
    if (stroke.tool != loaded) append(text, "LOADTL/%u\n", stroke.tool);
    loaded = stroke.tool;
    const auto above = [&](const DemoPose& pose) {
      return Vec3{pose.tip_mm.x, pose.tip_mm.y, retract_mm};
    };
    text += "RAPID\n";
    append_goto(text, above(stroke.poses.front()), stroke.poses.front().axis);
    append(text, "DELAY/%.1f\n", kRestSeconds);
    append(text, "FEDRAT/%.1f,MMPM\n", stroke.feed_mm_per_s * 60);
    for (const DemoPose& pose : stroke.poses) append_goto(text, pose.tip_mm, pose.axis);
    text += "RAPID\n";
    append_goto(text, above(stroke.poses.back()), stroke.poses.back().axis);
  }
  return text + "FINI\n";
}

double cutting_seconds(const std::vector<Stroke>& strokes) {
  double seconds = 0;
  for (const Stroke& stroke : strokes) {
    for (std::size_t i = 1; i < stroke.poses.size(); ++i) {
      seconds += length(stroke.poses[i].tip_mm - stroke.poses[i - 1].tip_mm) / stroke.feed_mm_per_s;
    }
  }
  return seconds;
}

}  // namespace kerf::demo
