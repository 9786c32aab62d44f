// SPDX-License-Identifier: Apache-2.0
#include "server/carve/simulation.h"

#include <algorithm>
#include <cmath>

#include "kernel/force/milling_force.h"
#include "kernel/math/rotation.h"
#include "server/verify/obstacle_push.h"

namespace kerf {
namespace {

constexpr int kObstaclePlacesMax = 10'001;  // along a motion
constexpr std::size_t kLinesMax = 1000;

double turn_rad(const ProgramMotion& motion) {
  return angle_between(normalized(motion.from.axis), normalized(motion.to.axis));
}

void keep_greatest(Extreme& extreme, double value, const ProgramMotion& motion) {
  if (value <= extreme.value) return;
  extreme = {value, motion.file, motion.line, motion.tool, motion.to.tip_mm};
}

/// Adds a cut to the entry of the motion's line.
void add_to_line(std::vector<LineVolume>& lines, const ProgramMotion& motion, double mm3,
                 double depth_mm) {
  const bool same_line =
      !lines.empty() && lines.back().line == motion.line && lines.back().file == motion.file;
  if (same_line) {
    lines.back().mm3 += mm3;
    lines.back().depth_mm = std::max(lines.back().depth_mm, depth_mm);
  } else if (lines.size() < kLinesMax) {
    lines.push_back({motion.file, motion.line, motion.tool, mm3, depth_mm});
  }
}

}  // namespace

Simulation::Simulation(const Scene& scene, const Program& program, bool look_for_obstacles)
    : scene_(scene), program_(program), machine_(dynamics_of(scene.machine)) {
  if (look_for_obstacles && !scene.settings.obstacles.empty())
    obstacles_.emplace(scene.settings.obstacles);
}

void Simulation::follow(const ProgramMotion& motion, const MotionResult& result, double depth_mm) {
  const double path_mm = length(motion.to.tip_mm - motion.from.tip_mm);
  const double turn = turn_rad(motion);
  machine_.add(motion);
  const bool cuts = result.removed_mm3 > kNothingRemovedMm3;
  ToolUse& use = tools_[motion.tool];
  use.removed_mm3 += result.removed_mm3;
  use.imprint_mm3 += result.imprint_mm3;
  if (result.imprint_mm3 > kNothingRemovedMm3)
    add_to_line(imprints_, motion, result.imprint_mm3, 0);
  const auto add = [&](Travel& travel) {
    travel.seconds += motion.duration_s;
    travel.length_mm += path_mm;
  };
  if (path_mm == 0 && turn == 0) {
    dwell_s_ += motion.duration_s;
  } else if (motion.rapid) {
    add(rapid_);
    if (cuts) add_to_line(rapid_cuts_, motion, result.removed_mm3, depth_mm);
  } else {
    add(feed_);
    add(use.feed);
    if (!cuts) {
      add(air_);
      add(use.air);
    }
  }
  double cut_mm3 = 0, force = 0;
  if (cuts) {
    // An imprint loads no tool.
    cut_mm3 = result.removed_mm3 - result.imprint_mm3;
    // Path of the contact; for a turn without travel, that of the middle of the tool.
    const double contact_mm =
        std::max(path_mm, turn * scene_.tools.at(motion.tool).tool.length_mm / 2);
    const double area = contact_mm > 0 ? cut_mm3 / contact_mm : 0;
    keep_greatest(use.engaged_area_mm2, area, motion);
    keep_greatest(use.removal_rate_mm3_per_s, cut_mm3 / motion.duration_s, motion);
    force = force_n(motion, result, area, cut_mm3);
    keep_greatest(use.force_n, force, motion);
  }
  loads_.add(motion, force, cut_mm3);
  stock_.follow(motion, result.stock_contact_mm);
  if (!obstacles_) return;
  obstacle_.follow(motion, greatest_push_n(*obstacles_, scene_.tools.at(motion.tool).tool, motion,
                                           scene_.settings.force.pivot_mm, kObstaclePlacesMax));
}

double Simulation::cycle_s(double tool_change_s) const {
  return feed_.seconds + rapid_.seconds + dwell_s_ +
         tool_change_s * static_cast<double>(program_.tool_changes.size());
}

// Returns the force of the wrench if it was computed, else that of the force law for area and rate.
double Simulation::force_n(const ProgramMotion& motion, const MotionResult& result, double area_mm2,
                           double cut_mm3) const {
  const Vec3 felt = result.wrench.force_n - result.collision.force_n;
  if (result.cutting.engaged_area_mm2 > 0) return length(felt);
  const ForceSettings& force = scene_.settings.force;
  if (force.law == ForceLaw::kMechanistic) {
    return milling_force_n(force.milling, scene_.tools.at(motion.tool).tool.radius_mm,
                           cut_mm3 / motion.duration_s);
  }
  return force.law == ForceLaw::kSpecificEnergy
             ? force.specific_force_n_per_mm2 * area_mm2
             : force.drr_n_s_per_mm3 * cut_mm3 / motion.duration_s;
}

}  // namespace kerf
