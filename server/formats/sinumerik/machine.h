// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/formats/gcode/arc.h"
#include "server/formats/gcode/canon.h"
#include "server/formats/scene.h"
#include "server/formats/sinumerik/block.h"
#include "server/formats/sinumerik/flow.h"

namespace kerf {

/// Executes the blocks of a SINUMERIK program and sends its motions to a GcodeCanon. Throws
/// GcodeFault.
class SinumerikMachine {
 public:
  using Warn = std::function<void(const std::string&)>;
  /// All arguments must outlive it. `changes_by_t`: the program has no M6, so that T changes tools.
  SinumerikMachine(const Scene& scene, SinumerikValues& values, GcodeCanon& canon, Warn warn,
                   bool changes_by_t);

  /// Executes a line; true if it ends the program.
  bool execute(const SinumerikLine& line);

 private:
  using Words = std::vector<SinumerikWord>;
  using Named = std::array<bool, 6>;
  enum class Motion { kRapid, kLine, kClockwise, kCounterClockwise, kThroughPoint };

  bool statement(const std::string& text);
  void define(std::string text);
  void keyword(SinumerikWord& word);
  void g_code(const SinumerikWord& word);
  void prepare(Words& words);
  void m_code(int code);
  void remark_spindle();
  void select_tool(const SinumerikWord& word);
  void change_tool();
  void assign(Words& words);

  // machine_frame.cpp: frames and transformations
  bool frame_statement(const std::string& text);
  void shift(Words& words, bool adds);
  void rotate(Words& words, bool adds);
  void follow_tool(bool on);

  // machine_motion.cpp
  void move(Words& words);
  GcodeAxes target(Words& words, Named& named);
  std::optional<Vec3> tool_axis(Words& words);
  void straight(const GcodeAxes& to, const Named& named);
  void arc(Words& words, const GcodeAxes& to, const Named& named);
  PlanePoint center(Words& words, Vec3 from, Vec3 to, bool& clockwise);
  PlanePoint through(Words& words, Vec3 from, Vec3 to, bool& clockwise);
  GcodeFeed feed() const;
  GcodePlace place(const GcodeAxes& programmed) const;
  void go_to_machine(Words& words);
  void dwell(Words& words);
  static SinumerikWord* take(Words& words, std::string_view name);

  // machine_cycle.cpp
  bool cycle_statement(const std::string& text);
  void swivel(const std::vector<std::optional<double>>& given);
  void drill();

  struct Hole {
    double retract = 0, above = 0, bottom = 0, seconds = 0;
    std::optional<double> feed;
  };

  const Scene& scene_;
  SinumerikValues& values_;
  GcodeCanon& canon_;
  Warn warn_;
  const bool changes_by_t_;
  std::set<std::string> warned_;

  Motion motion_ = Motion::kLine;
  ArcPlane plane_ = ArcPlane::kXy;
  double unit_mm_ = 1, feed_unit_mm_ = 1;
  bool incremental_ = false, follows_tool_ = false, in_machine_ = false, dwells_ = false;
  enum class FeedMode { kPerMinute, kPerRevolution, kInverse } feed_mode_ = FeedMode::kPerMinute;
  double feed_ = 0, rpm_ = 0;
  std::optional<MachineRemark::Kind> turning_;
  std::optional<ToolId> selected_;
  std::map<std::string, ToolId> named_tools_;
  int system_ = 0;  ///< G54: 54
  GcodeFrame frame_;
  GcodeAxes at_{};  ///< absolute
  Vec3 axis_{0, 0, 1};
  std::optional<Hole> modal_hole_, hole_;
  bool ends_ = false;
};

}  // namespace kerf
