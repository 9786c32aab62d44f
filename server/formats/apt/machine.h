// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "server/formats/apt/statement.h"
#include "server/formats/apt/tools.h"
#include "server/formats/motion_sink.h"
#include "server/formats/scene.h"

namespace kerf {

/// Executes the statements of APT CL data. Throws ProgramFault.
class AptMachine {
 public:
  using Warn = std::function<void(const std::string&)>;

  /// `scene`, `tools` and `sink` must outlive it. Each warning is given once.
  AptMachine(const Scene& scene, const AptTools& tools, MotionSink& sink, Warn warn)
      : scene_(scene), tools_(tools), sink_(sink), warn_(std::move(warn)) {}

  /// Executes a statement of a line. Returns true at FINI.
  bool execute(const AptStatement& statement, std::size_t line);
  /// Whether the program has a statement of APT.
  bool knows_any() const { return knows_any_; }
  /// Whether the program is divided into the tool paths of NX, which need no FINI.
  bool has_paths() const { return has_paths_; }

 private:
  using Handler = void (AptMachine::*)(const AptStatement&);
  struct Named {
    std::string_view major;
    Handler handler;
  };
  static const Named kStatements[];

  enum class FeedUnit { kPerMinute, kPerRevolution };
  struct Feed {
    double written = 0;  ///< degrees per minute if only the axis turns
    double mm = 0;
    FeedUnit unit = FeedUnit::kPerMinute;
  };
  /// CIRCLE: the arc that contains the next GOTO.
  struct Circle {
    Vec3 center_mm, axis;
  };
  /// CYCLE: the hole that each GOTO drills, as distances from its point along the axis.
  struct Cycle {
    double depth_mm = 0, approach_mm = 0;
    std::optional<double> retract_mm;  ///< nullopt: to the height at the start of the cycle
    double start_mm = 0;               ///< that height, along the axis
    double dwell_s = 0;
    Feed feed;
  };

  // machine.cpp
  void free_text(const AptStatement& s);
  void ignore(const AptStatement&) {}
  void fini(const AptStatement&) { finished_ = true; }
  void stop(const AptStatement& s);
  void units(const AptStatement& s);
  void multax(const AptStatement& s);
  void tool_path(const AptStatement& s);
  void load_tool(const AptStatement& s);
  void unload(const AptStatement&);
  void change_tool(const std::string& number);
  void cutter(const AptStatement& s);
  void check_cutter();
  void feed_rate(const AptStatement& s);
  void rapid(const AptStatement& s);
  void spindle(const AptStatement& s);
  void coolant(const AptStatement& s);
  void delay(const AptStatement& s);
  void system(const AptStatement& s);
  void translation(const AptStatement& s);
  void cutter_offset(const AptStatement& s);
  void refuse(const AptStatement& s);
  void warn_once(const std::string& text);
  bool take_feed_unit(const std::string& word, Feed& feed, double& unit) const;

  // machine_motion.cpp
  void from(const AptStatement& s);
  void go_to(const AptStatement& s);
  void go_delta(const AptStatement& s);
  void go_home(const AptStatement&);
  void tool_axis(const AptStatement& s);
  void circle(const AptStatement& s);
  void direction(const AptStatement& s);
  void circle_to_line(const AptStatement& s);
  void cycle(const AptStatement& s);
  ToolPose read_pose(const AptStatement& s) const;
  Vec3 read_axis(const AptStatement& s, std::size_t first) const;
  void check_tilt(Vec3 axis) const;
  void require_tool();
  void move(const ToolPose& to);
  void straight(const ToolPose& to, bool rapid);
  void arc(Circle circle, ToolPose to);
  void hole(const ToolPose& at);
  double feed_mm_per_min(const Feed& feed) const;
  double duration_s(const ToolPose& from, const ToolPose& to, bool rapid) const;
  static void check(const MotionSink::Result& result);

  const Scene& scene_;
  const AptTools& tools_;
  MotionSink& sink_;
  Warn warn_;
  std::set<std::string> warned_;
  std::size_t line_ = 0;
  bool finished_ = false, knows_any_ = false, has_paths_ = false;
  double unit_mm_ = 1;
  bool rapid_ = false;
  Feed feed_;
  double spindle_rpm_ = 0;
  Vec3 axis_{0, 0, 1};
  std::optional<double> cutter_mm_;    ///< diameter of a CUTTER that no motion has used yet
  std::optional<std::string> system_;  ///< the first CSYS or MSYS
  bool in_world_ = false;              ///< TRNTYP/WORLD: CSYS does not change coordinates
  std::optional<Circle> circle_;
  std::optional<Circle> last_circle_;  ///< Creo's, whose points may all be on it
  std::optional<Vec3> direction_;      ///< INDIRV
  std::optional<Cycle> cycle_;
};

}  // namespace kerf
