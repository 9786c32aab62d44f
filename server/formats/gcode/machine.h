// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/gcode/block.h"
#include "server/formats/gcode/canon.h"
#include "server/formats/gcode/compensation.h"
#include "server/formats/gcode/cycle.h"
#include "server/formats/gcode/modes.h"
#include "server/formats/gcode/tool_table.h"

namespace kerf {

/// What kind of machine an interpreter stands for.
struct GcodeSetup {
  std::string machine_name;          ///< in errors
  std::string_view axes = "xyzabc";  ///< those that it has
  double machine_unit_mm = 1;        ///< of #-parameters that tell offsets, homes and tools
  double unit_mm = 1;                ///< until G20 or G21
  bool tool_axis_words = false;      ///< I J K on G0 and G1 give the tool's axis
  ToolTable tools;
  bool tools_of_scene = false;      ///< nobody gave a tool table: lengths are 0
  bool machine_zero_known = false;  ///< machine coordinates mean a place in the workpiece
};

/// Most motions and dwells that a program may ask for: a cycle's L is one short word.
inline constexpr std::size_t kGcodeCallsMax = 20'000'000;

/// The modal state of an RS-274 controller: executes blocks in LinuxCNC's order and tells a canon
/// what to do. Throws GcodeFault.
class GcodeMachine {
 public:
  using Warn = std::function<void(const std::string&)>;

  /// Takes offsets and the selected coordinate system from the parameters. All four outlive it.
  GcodeMachine(GcodeSetup setup, GcodeParameters& parameters, GcodeCanon& canon, Warn warn);

  /// The block that follows stands here; tells the position to the parameters.
  void at_line(std::size_t file, std::size_t line);
  /// #5420 to #5428 may be read.
  bool position_readable() const { return !compensation_.on(); }
  /// True if the block ends the program (M2, M30, M99).
  bool execute(GcodeBlock& block);
  /// A block since at_line() has asked the canon for a motion or a dwell.
  bool moved() const { return calls_ != calls_before_; }
  /// Emits what waits for the next move.
  void finish();
  /// The value of #<_x>, #<_feed>, …; none for other names.
  std::optional<double> predefined(const std::string& name) const;

  /// M70 to M73 keep what they save with the subroutine.
  void enter_subroutine() { saved_.emplace_back(); }
  void leave_subroutine();
  /// What #<_value>, #<_value_returned> tell; the call level is told by enter and leave.
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
  double pocket(std::optional<int> number, double none) const;

  // machine.cpp, machine_codes.cpp: the order of a block, feeds, M codes
  void decide_motion(const GcodeBlock& block);
  void reject_foreign_axes(const GcodeBlock& block) const;
  void set_spindle_and_feed(GcodeBlock& block);
  void set_feed_mode(int code);
  void set_modes(GcodeBlock& block);
  void execute_m(GcodeBlock& block);
  void turn_spindle(GcodeBlock& block, int code);
  void override_speeds(GcodeBlock& block, int code);
  void use_input_output(GcodeBlock& block, int code);
  void restore(const GcodeModes& modes);
  bool stop(const GcodeBlock& block);
  void reject_compensated(const GcodeCode& code) const;
  void control_tool_center(bool by_length_code, bool by_m_code);

  // tool.cpp
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

  // offsets.cpp: coordinate systems
  /// Six parameters from `first` on, brought to mm and degrees; and the inverse.
  GcodeAxes stored_axes(int first) const;
  void store_axis(int first, std::size_t axis, double value);
  GcodeAxes system_origin(int system) const;
  double system_rotation(int system) const;
  GcodeAxes applied_shift() const;
  void change_frame(const GcodeFrame& frame);
  void select_system(int system);
  void set_system(GcodeBlock& block);
  void shift_origin(GcodeBlock& block, int code);
  void restore_shift(int code);
  void save_home(int code);
  GcodeAxes in_system(int system) const;
  void execute_nonmodal(GcodeBlock& block);

  // motion.cpp
  void move(GcodeBlock& block);
  void straight(GcodeBlock& block, int code);
  void arc(GcodeBlock& block, bool clockwise);
  void spline(GcodeBlock& block, bool cubic);
  void tap(GcodeBlock& block);
  void cycle(GcodeBlock& block, int code);
  CycleWords read_cycle(GcodeBlock& block, int code) const;
  void go_home(GcodeBlock& block, int code);
  GcodeAxes read_target(GcodeBlock& block);
  GcodeAxes read_machine_target(GcodeBlock& block);
  void read_polar(GcodeBlock& block, GcodeAxes& to);
  Vec3 read_tool_axis(GcodeBlock& block);
  ArcCenter read_center(GcodeBlock& block) const;
  void require_feed(const GcodeBlock& block) const;
  GcodeFeed feed_of(const GcodeBlock& block) const;
  void emit(const CompensatedMove& move);
  void rapid(const GcodeAxes& to, GcodeRapid kind, const Named& named);
  void feed(const GcodeAxes& to, const GcodeFeed& feed, const Named& named);
  GcodePlace place(const GcodeAxes& programmed) const;
  void arrive(const GcodeAxes& programmed);
  void count_call();
  static Named named_axes(const GcodeBlock& block);

  GcodeSetup setup_;
  GcodeParameters& parameters_;
  GcodeCanon& canon_;
  Warn warn_;
  std::size_t file_ = 0, line_ = 0, calls_ = 0, calls_before_ = 0;

  GcodeModes modes_;
  GcodeFrame frame_;
  GcodeAxes at_{};  ///< programmed coordinates; compensated ones while the cutter's radius is
  Vec3 tool_axis_{0, 0, 1};
  GcodeAxes actual_{};  ///< without offsets: where the last motion that was told has ended
  GcodeAxes tool_offset_{};
  int motion_to_be_ = -1;  ///< of the block at hand; -1: none
  CutterCompensation compensation_;
  CycleMemory cycle_;
  double spline_i_ = 0, spline_j_ = 0;  ///< where the last G5 pointed
  bool arc_rejected_ = false;           ///< the tool is beside the path since G40
  std::optional<int> selected_tool_;
  int loaded_tool_ = 0;
  bool tcp_by_length_code_ = false, tcp_by_m_code_ = false;
  std::vector<Saved> saved_ = std::vector<Saved>(1);
  std::optional<double> returned_;
};

}  // namespace kerf
