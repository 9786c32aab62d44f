// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/control/canon.h"
#include "server/formats/control/compensation.h"
#include "server/formats/control/corner.h"
#include "server/formats/gcode/block.h"
#include "server/formats/gcode/cycle.h"
#include "server/formats/gcode/modes.h"
#include "server/formats/gcode/outline_pocket.h"
#include "server/formats/gcode/setup.h"

namespace kerf {

/// Most motions and dwells of a program, because the L word of a cycle can request any number.
inline constexpr std::size_t kGcodeCallsMax = 20'000'000;

/// The modal state of an RS-274 controller. Executes blocks in LinuxCNC's order and makes the
/// canonical calls. Throws ProgramFault.
class GcodeMachine {
 public:
  using Warn = std::function<void(const std::string&)>;

  /// Reads the work offsets and the active coordinate system from the parameters. `parameters` and
  /// `canon` must outlive it.
  GcodeMachine(GcodeSetup setup, GcodeParameters& parameters, GcodeCanon& canon, Warn warn);

  /// Sets file and line of the next block and updates the position parameters (#5420 to #5425).
  void at_line(std::size_t file, std::size_t line);
  /// Whether #5420 to #5428 may be read.
  bool position_readable() const { return !compensation_.on(); }
  /// Executes a block up to the start of its motion. The steps of a canned cycle follow: call
  /// go_on() until it returns false, then end().
  void begin(GcodeBlock& block);
  /// Makes the next step of a cycle. Returns false, without effect, if no step is left.
  bool go_on();
  /// The program to call next because it has the outline of a pocket (G150), if begin() requests
  /// one.
  std::optional<int> take_outline_program();
  /// Makes the next motions of a pocket with a complete outline. Returns false if none is left.
  bool mill_on();
  /// Completes a block. Returns true if it ends the program (M2, M30, M99).
  bool end(const GcodeBlock& block);
  /// Whether a motion or a dwell has been made since at_line().
  bool moved() const { return calls_ != calls_before_; }
  /// Emits the move that cutter compensation delays.
  void finish();
  /// Returns the value of a predefined parameter (#<_x>, #<_feed>, …), or nullopt for other names.
  std::optional<double> predefined(const std::string& name) const;

  /// The modes saved by M70 and M73 belong to the subroutine.
  void enter_subroutine() { saved_.emplace_back(); }
  void leave_subroutine();
  /// Sets #<_value> and #<_value_returned>.
  void set_returned(std::optional<double> value) { returned_ = value; }

 private:
  struct Saved {
    std::optional<GcodeModes> modes;
    bool compensated = false;
    bool restore_on_return = false;
  };
  using Named = std::array<bool, 6>;
  struct Predefined {
    std::string_view name;
    double (*value)(const GcodeMachine&);
  };

  // predefined.cpp
  static const Predefined kPredefined[];
  std::optional<double> predefined_position(const std::string& name) const;
  double pocket(std::optional<int> number, double standard) const;

  // machine.cpp, machine_codes.cpp: order of execution, feeds, M codes
  void decide_motion(const GcodeBlock& block);
  void reject_foreign_axes(const GcodeBlock& block) const;
  void set_spindle_and_feed(GcodeBlock& block);
  void set_feed_mode(int code);
  void set_modes(GcodeBlock& block);
  void execute_m(GcodeBlock& block);
  void turn_spindle(GcodeBlock& block, int code);
  void remark_spindle();
  void override_speeds(GcodeBlock& block, int code);
  void use_input_output(GcodeBlock& block, int code);
  void restore(const GcodeModes& modes);
  bool stop(const GcodeBlock& block);
  void reject_compensated(const GcodeCode& code) const;
  void control_tool_center(bool by_length_code, bool by_m_code);

  // machine_tool.cpp: tools and their offsets
  void select_tool(GcodeBlock& block);
  void change_tool(GcodeBlock& block, int code);
  void offset_tool(GcodeBlock& block, int code);
  void apply_tool_offset(const GcodeAxes& offset);
  void set_tool_entry(GcodeBlock& block, int kind);
  GcodeAxes measured_offset(const GcodeBlock& block, int system, ToolTableEntry entry);
  void publish_tool();
  const ToolTableEntry* tool(int number) const;
  const ToolTableEntry& tool_of_word(const GcodeWord& word) const;
  void start_compensation(GcodeBlock& block, int code);

  // machine_offsets.cpp: coordinate systems
  /// Reads six parameters from number `first`, converted to mm and degrees; store_axis is the
  /// inverse for one of them.
  GcodeAxes stored_axes(int first) const;
  void store_axis(int first, std::size_t axis, double value);
  double stored_unit_mm() const;
  void convert_stored(double factor);
  GcodeAxes stored_origin(int system) const;
  GcodeAxes system_origin(int system) const;
  bool is_set(int system, std::size_t axis) const;
  /// Whether G54 is the scene's zero, independent of the machine's zero.
  bool zero_is_shop() const { return setup_.rules.of_fanuc() && !setup_.machine_zero_known; }
  void refer_systems();
  double system_rotation(int system) const;
  GcodeAxes applied_shift() const;
  void change_frame(const GcodeFrame& frame);
  void select_system(int system);
  void follow_assigned_origin();
  void set_system(GcodeBlock& block);
  void shift_origin(GcodeBlock& block, int code);
  void restore_shift(int code);
  void save_home(int code);
  GcodeAxes in_system(int system) const;
  void execute_nonmodal(GcodeBlock& block);

  // machine_macro.cpp: words of the controls with Macro B
  void prepare(GcodeBlock& block);
  void prepare_units(GcodeBlock& block);
  void prepare_rotation(GcodeBlock& block) const;
  void ignore_power(GcodeBlock& block);
  void warn_of_ambiguity(const GcodeBlock& block);
  void ignore_codes(GcodeBlock& block);
  bool block_uses_cycle(const GcodeBlock& block) const;
  bool takes_more_systems(const GcodeBlock& block) const;
  void prepare_dwell(GcodeBlock& block) const;
  void prepare_home(GcodeBlock& block);
  void prepare_offsets(GcodeBlock& block);
  void prepare_systems(GcodeBlock& block);
  void prepare_polar(GcodeBlock& block);
  void prepare_motion(GcodeBlock& block);
  void publish_macro_variables();
  void warn_once(const std::string& key, const std::string& text);
  double offset_register_mm(const GcodeWord* d);

  // machine_transform.cpp: rotation, scaling and mirror images of the program
  void transform(GcodeBlock& block);
  void end_transform();
  void rotate_program(GcodeBlock& block);
  void scale_program(GcodeBlock& block);
  void take_mirror_end(GcodeBlock& block, const GcodeCode& code);
  void mirror_program(GcodeBlock& block, int code);
  void set_transform(const GcodeFrame& frame);
  void check_after_transform(const GcodeBlock& block);

  // machine_corner.cpp: rounded and cut corners (,R ,C)
  struct Corner {
    CornerSize size;
    GcodeAxes at{};  ///< the corner; the tool is still at the start of the first line
    GcodeFeed feed;
    Named named{};
    std::size_t file = 0, line = 0;
  };
  bool begin_corner(GcodeBlock& block, const GcodeAxes& to);
  static CompensatedInfo info_of(const Corner& corner, const GcodeAxes& to);
  void cut_corner(const GcodeAxes& next);
  void require_no_corner() const;

  // machine_pocket.cpp: circular pockets, holes on a circle
  void circle_to(const GcodeAxes& to, Vec3 center, int turns, const GcodeFeed& speed);
  double pocket_offset_mm(const GcodeBlock& block);
  void circular_pocket(GcodeBlock& block, bool clockwise);
  bool begin_pattern(GcodeBlock& block, const GcodeCode& code);
  bool next_of_pattern();

  // machine_outline.cpp: pockets within an outline (G150)
  /// A pocket while its outline is read, and then while it is milled.
  struct MilledPocket {
    int program = 0;  ///< that states the outline
    bool is_called = false, is_complete = false;
    std::size_t depth = 0;  ///< of calls, around the program
    std::size_t file = 0, line = 0;
    double top = 0, bottom = 0, infeed = 0, step = 0, finish = 0, radius = 0;  ///< mm
    bool along_x = true;
    int side = 0;  ///< 1: G41, -1: G42
    GcodeAxes start{};
    GcodeFeed speed;
    AreaPath outline;
    std::optional<OutlinePocket> roughed, finished;
    AreaPath rough_loop, finish_loop;
    std::vector<OutlineStroke> strokes;
    std::deque<double> levels;  ///< that are left
  };
  bool reads_outline() const { return pocket_ && !pocket_->is_complete; }
  void take_outline_side(GcodeBlock& block);
  void begin_outline(GcodeBlock& block);
  void record_outline(const GcodeAxes& to, std::optional<PlanePoint> center, int turns);
  void end_outline();
  void go_to_height(double height);
  void go_above(const MilledPocket& pocket, OutlinePoint to);
  void go_in_pocket(const MilledPocket& pocket, const OutlinePocket& area, OutlinePoint to,
                    double level);
  void follow_loop(const MilledPocket& pocket, const OutlinePocket& area, const AreaPath& loop,
                   double level);

  // machine_motion.cpp, machine_spline.cpp: motions
  void move(GcodeBlock& block);
  void straight(GcodeBlock& block, int code);
  void arc(GcodeBlock& block, bool clockwise);
  void spline(GcodeBlock& block, bool cubic);
  void tap(GcodeBlock& block);
  void cycle(GcodeBlock& block, int code);
  CycleWords read_cycle(GcodeBlock& block, int code) const;
  void go_home(GcodeBlock& block, int code);
  GcodeAxes read_target(GcodeBlock& block);
  void return_to_path(const GcodeBlock& block, GcodeAxes& to);
  GcodeAxes read_machine_target(GcodeBlock& block);
  void read_polar(GcodeBlock& block, GcodeAxes& to);
  Vec3 read_tool_axis(GcodeBlock& block);
  ArcCenter read_center(GcodeBlock& block) const;
  void follow_line(bool is_rapid, const GcodeAxes& to, const CompensatedInfo& info);
  void follow_arc(const GcodeAxes& to, const ArcCenter& center, bool clockwise, int turns,
                  double tolerance_mm, const CompensatedInfo& info);
  void require_feed(const GcodeBlock& block) const;
  GcodeFeed feed_of(const GcodeBlock& block) const;
  void emit(const CompensatedMove& move);
  void rapid(const GcodeAxes& to, GcodeRapid kind, const Named& named);
  void feed(const GcodeAxes& to, const GcodeFeed& feed, const Named& named);
  GcodePlace place(const GcodeAxes& programmed) const;
  void set_position(const GcodeAxes& programmed);
  void count_call();
  static Named named_axes(const GcodeBlock& block);

  GcodeSetup setup_;
  GcodeParameters& parameters_;
  GcodeCanon& canon_;
  Warn warn_;
  std::size_t file_ = 0, line_ = 0, calls_ = 0, calls_before_ = 0;

  GcodeModes modes_;
  GcodeFrame frame_;
  GcodeAxes at_{};  ///< position in programmed coordinates; that of the tool center if compensated
  Vec3 tool_axis_{0, 0, 1};
  GcodeAxes actual_{};  ///< end of the last canonical motion, absolute coordinates
  GcodeAxes tool_offset_{};
  int block_motion_ = -1;  ///< motion code of the current block; -1 without motion
  CutterCompensation compensation_;
  CycleMemory cycle_;
  struct RunningCycle {
    Cycle cycle;
    ArcPlane plane;
    Named named;
    GcodeFeed speed;
  };
  std::optional<RunningCycle> running_;
  std::deque<PlanePoint> pattern_;      ///< holes that the active cycle has yet to drill
  int modal_motion_ = 0;                ///< before the block
  double spline_i_ = 0, spline_j_ = 0;  ///< first control point that continues the last G5
  bool arc_rejected_ = false;         ///< G40 left the tool offset from the path: no arc may follow
  std::optional<PlanePoint> beside_;  ///< Macro B: the programmed point at that G40
  std::optional<int> selected_tool_;
  int loaded_tool_ = 0;
  bool tcp_by_length_code_ = false, tcp_by_m_code_ = false;
  std::vector<Saved> saved_ = std::vector<Saved>(1);
  std::optional<double> returned_;

  // Macro B
  int path_motion_ = 0;                      ///< G0 to G3, which G80 restores
  bool polar_ = false;                       ///< G16
  bool block_is_machine_ = false;            ///< G53: the modal motion is kept
  std::optional<GcodeFrame> untransformed_;  ///< the frame without rotation, scaling and mirror
  GcodeGroup transform_group_{};  ///< the group of that transform: kRotation, kScaling or kMirror
  bool transform_moved_ = false;  ///< X and Y have not both been programmed since the transform
  std::optional<Corner> corner_;
  int outline_side_ = 0;  ///< G41 or G42 in the block of G150
  std::optional<MilledPocket> pocket_;
  bool unit_given_ = false;  ///< G20 or G21
  /// Fanuc, Haas: the scene's zero in machine coordinates, once an axis has a reference.
  std::array<std::optional<double>, 6> zero_{};
  std::map<int, std::array<bool, 6>> set_systems_;  ///< axes whose offset G10 has set
  std::set<std::string> warned_;
  std::set<int> systems_;
};

}  // namespace kerf
