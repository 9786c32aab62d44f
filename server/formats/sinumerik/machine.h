// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/formats/control/arc.h"
#include "server/formats/control/area_path.h"
#include "server/formats/control/canon.h"
#include "server/formats/control/compensation.h"
#include "server/formats/control/corner.h"
#include "server/formats/scene.h"
#include "server/formats/sinumerik/block.h"
#include "server/formats/sinumerik/flow.h"

namespace kerf {

/// Executes the blocks of a SINUMERIK program and sends its motions to a GcodeCanon. Throws
/// ProgramFault.
class SinumerikMachine {
 public:
  using Warn = std::function<void(const std::string&)>;
  /// All arguments must outlive it. `changes_by_t`: the program has no M6, so T changes tools.
  /// `offsets_are_wear`: the path is that of the tool's center, so G41 has no offset.
  SinumerikMachine(const Scene& scene, SinumerikValues& values, GcodeCanon& canon, Warn warn,
                   bool changes_by_t, bool offsets_are_wear);

  /// Executes a line, numbered from 1. Returns true if it ends the program.
  bool execute(const SinumerikLine& line, std::size_t number);
  /// Makes the move that radius compensation delays.
  void finish();

 private:
  using Words = std::vector<SinumerikWord>;
  using Named = std::array<bool, 6>;
  struct Corner {
    CornerSize size;
    bool own = false;  ///< of this block, not RNDM
    GcodeAxes at{};    ///< the corner; the tool is still at the start of the first line
    Named named{};
    GcodeFeed feed;
    bool any() const { return size.radius_mm > 0 || size.chamfer_mm > 0 || size.leg_mm > 0; }
    bool is_modal() const { return !own; }
  };
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
  void line(const GcodeAxes& to, const Named& named, bool turns, Corner corner);
  void go_straight(const GcodeAxes& to, const Named& named, bool rapid, const GcodeFeed& speed);
  void go_round(const GcodeAxes& to, const Named& named, PlanePoint middle, bool clockwise,
                int turns, const GcodeFeed& speed);
  void arc(Words& words, const GcodeAxes& to, const Named& named);
  PlanePoint center(Words& words, Vec3 from, Vec3 to, bool& clockwise);
  PlanePoint through(Words& words, Vec3 from, Vec3 to, bool& clockwise);
  GcodeFeed feed() const;
  GcodePlace place(const GcodeAxes& programmed) const;
  void go_to_machine(Words& words);
  void dwell(Words& words);
  static SinumerikWord* take(Words& words, std::string_view name);

  // machine_corner.cpp: corners between lines
  void read_corner(Words& words, Corner& corner);
  void require_no_corner(const std::string& word) const;
  void release_corner();
  void cut_corner(const GcodeAxes& next);

  // machine_offset.cpp: radius compensation
  void refuse_compensated(const std::string& word);
  double tool_radius_mm(const std::string& word) const;
  double offset_mm();
  void compensate(int code);
  GcodeAxes programmed() const;
  CompensatedInfo info_of(const GcodeAxes& to, const Named& named, const GcodeFeed& speed) const;
  void stand_beside(const GcodeAxes& to, PlanePoint center);
  void emit(const CompensatedMove& move);

  // machine_cycle.cpp
  bool cycle_statement(const std::string& text);
  bool area_statement(std::string_view name, const std::vector<std::optional<double>>& given);
  void swivel(const std::vector<std::optional<double>>& given);
  void drill_pattern(std::string_view name, const std::vector<std::optional<double>>& given);
  void drill();

  // machine_area.cpp
  struct Area {
    double retract = 0, reference = 0, safety = 0, bottom = 0;
    std::optional<double> feed, plunge;
    std::vector<std::pair<AreaPath, double>> passes;  ///< paths and their levels
  };
  void mill(const Area& area, const std::string& word);
  void require_no_swivel() const;

  struct Hole {
    double retract = 0, above = 0, bottom = 0, seconds = 0;
    std::optional<double> feed;
  };

  const Scene& scene_;
  SinumerikValues& values_;
  GcodeCanon& canon_;
  Warn warn_;
  const bool changes_by_t_, offsets_are_wear_;
  std::set<std::string> warned_;

  Motion motion_ = Motion::kLine;
  ArcPlane plane_ = ArcPlane::kXy;
  double unit_mm_ = 1, feed_unit_mm_ = 1;
  bool incremental_ = false, follows_tool_ = false, in_machine_ = false, dwells_ = false;
  enum class FeedMode { kPerMinute, kPerRevolution, kInverse } feed_mode_ = FeedMode::kPerMinute;
  double feed_ = 0, rpm_ = 0;
  std::optional<MachineRemark::Kind> turning_;
  std::optional<ToolId> selected_, loaded_;
  std::map<std::string, ToolId> named_tools_;
  int system_ = 0;  ///< G54: 54
  GcodeFrame frame_;
  GcodeAxes at_{};                    ///< absolute; the tool's center while compensated
  GcodeAxes actual_{};                ///< the end of the last completed compensated move, absolute
  std::optional<PlanePoint> beside_;  ///< the programmed point at which G40 left the tool offset
  std::size_t line_ = 0;
  CutterCompensation compensation_;
  std::optional<Corner> corner_;
  double modal_round_mm_ = 0;  ///< RNDM
  Vec3 axis_{0, 0, 1};
  std::optional<Hole> modal_hole_, hole_;
  bool ends_ = false;
  bool tilted_ = false;       ///< by CYCLE800
  bool swivel_open_ = false;  ///< the plane ended with turned tables
};

}  // namespace kerf
