// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "kernel/force/collision.h"
#include "kernel/sculpture.h"
#include "server/carve/load_curve.h"
#include "server/carve/stock_contacts.h"
#include "server/formats/machine_time.h"
#include "server/formats/program.h"
#include "server/formats/scene.h"

namespace kerf {

/// Removed volumes below this are rounding on a surface that was cut before, mm^3.
inline constexpr double kNothingRemovedMm3 = 1e-6;

/// A maximum with its position in the program.
struct Extreme {
  double value = 0;
  std::uint32_t file = 0, line = 0;
  ToolId tool = 0;
  Vec3 tip_mm;  ///< at the end of the motion
};

/// Time and length of motions of one kind.
struct Travel {
  double seconds = 0, length_mm = 0;
};

/// Statistics of one tool.
struct ToolUse {
  Travel feed, air;                         ///< air: feed motions that removed nothing
  double removed_mm3 = 0, imprint_mm3 = 0;  ///< imprint: a part of the removed volume
  Extreme engaged_area_mm2, removal_rate_mm3_per_s, force_n;
};

/// The volume removed by the motions of one line of the program.
struct LineVolume {
  std::uint32_t file = 0, line = 0;
  ToolId tool = 0;
  double mm3 = 0;
  double depth_mm = 0;  ///< of the deepest motion; rapids only
};

/// Collects the figures of an NC verification while a program is carved: times, loads, collisions,
/// rapids through material. README.md defines each figure.
class Simulation {
 public:
  /// Both arguments must outlive this object. Obstacles are tested only if requested, because that
  /// samples every motion.
  Simulation(const Scene& scene, const Program& program, bool look_for_obstacles);

  /// Adds the next motion of the program and its result. `depth_mm`: how deep it has cut
  /// (CutDepth), for a rapid.
  void follow(const ProgramMotion& motion, const MotionResult& result, double depth_mm = 0);

  const Travel& feed() const { return feed_; }
  const Travel& air() const { return air_; }
  const Travel& rapid() const { return rapid_; }
  /// Time on the scene's machine without tool changes, s.
  double machine_s() const { return machine_.total_s(); }
  double dwell_s() const { return dwell_s_; }
  /// Returns the cycle time: all motions, and tool changes of `tool_change_s` each.
  double cycle_s(double tool_change_s) const;
  const LoadCurve& loads() const { return loads_; }
  const std::map<ToolId, ToolUse>& tools() const { return tools_; }
  const ContactRuns& stock_contacts() const { return stock_; }
  /// Contacts of tool, shank or holder with obstacles. The amount is the contact force, N.
  const ContactRuns& obstacle_contacts() const { return obstacle_; }
  /// Volumes removed by rapid motions. One entry per line in program order, at most 1000.
  const std::vector<LineVolume>& rapid_cuts() const { return rapid_cuts_; }
  /// The imprints of tools whose motion started inside stock, in the same form.
  const std::vector<LineVolume>& imprints() const { return imprints_; }
  const Program& program() const { return program_; }
  const Scene& scene() const { return scene_; }

 private:
  double force_n(const ProgramMotion& motion, const MotionResult& result, double area_mm2,
                 double cut_mm3) const;

  const Scene& scene_;
  const Program& program_;
  std::optional<Obstacles> obstacles_;
  Travel feed_, air_, rapid_;
  MachineTime machine_;
  double dwell_s_ = 0;
  LoadCurve loads_;
  std::map<ToolId, ToolUse> tools_;
  ContactRuns stock_, obstacle_;
  std::vector<LineVolume> rapid_cuts_, imprints_;
};

}  // namespace kerf
