// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "kernel/force/collision.h"
#include "kernel/sculpture.h"
#include "server/carve/stock_contacts.h"
#include "server/formats/program.h"
#include "server/formats/scene.h"

namespace kerf {

/// Less than this is rounding on a surface that was cut before, mm^3.
inline constexpr double kNothingRemovedMm3 = 1e-6;

/// The greatest of something, and where.
struct Extreme {
  double value = 0;
  std::uint32_t file = 0, line = 0;
  ToolId tool = 0;
  Vec3 tip_mm;  ///< at the end of the motion
};

/// Time and way of motions of one kind.
struct Travel {
  double seconds = 0, length_mm = 0;
};

/// What one tool did.
struct ToolUse {
  Travel feed, air;  ///< air: feed motions that removed nothing
  double removed_mm3 = 0;
  Extreme engaged_area_mm2, removal_rate_mm3_per_s, force_n;
};

/// A rapid that went through material.
struct RapidCut {
  std::uint32_t file = 0, line = 0;
  ToolId tool = 0;
  double removed_mm3 = 0;
};

/// Watches a carving: what a machinist asks of a program before he runs it. README.md tells each
/// figure.
class Simulation {
 public:
  /// Both outlive it. Obstacles are looked for only if asked: that walks along every motion.
  Simulation(const Scene& scene, const Program& program, bool look_for_obstacles);

  /// The next motion of the program, and what it did.
  void follow(const ProgramMotion& motion, const MotionResult& result);

  const Travel& feed() const { return feed_; }
  const Travel& air() const { return air_; }
  const Travel& rapid() const { return rapid_; }
  double dwell_s() const { return dwell_s_; }
  const std::map<ToolId, ToolUse>& tools() const { return tools_; }
  const ContactRuns& stock_contacts() const { return stock_; }
  /// Obstacles that a tool, its shank or its holder touched; the amount is the push, N.
  const ContactRuns& obstacle_contacts() const { return obstacle_; }
  /// One entry for each line, in the order of the program, the first 1000 of them.
  const std::vector<RapidCut>& rapid_cuts() const { return rapid_cuts_; }
  const Program& program() const { return program_; }

 private:
  double obstacle_push_n(const ProgramMotion& motion) const;
  double force_n(const ProgramMotion& motion, const MotionResult& result, double area_mm2) const;
  void note_rapid_cut(const ProgramMotion& motion, double removed_mm3);

  const Scene& scene_;
  const Program& program_;
  std::optional<Obstacles> obstacles_;
  Travel feed_, air_, rapid_;
  double dwell_s_ = 0;
  std::map<ToolId, ToolUse> tools_;
  ContactRuns stock_, obstacle_;
  std::vector<RapidCut> rapid_cuts_;
};

}  // namespace kerf
