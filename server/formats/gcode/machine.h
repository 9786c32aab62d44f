#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/formats/gcode/arc.h"
#include "server/formats/gcode/block.h"
#include "server/formats/machine_kinematics.h"
#include "server/formats/motion_sink.h"
#include "server/formats/scene.h"

namespace kerf {

/// The modal state of an RS-274 controller: executes blocks and puts their motions into a sink. The
/// current position is kept in the coordinates of the workpiece without offsets. Throws GcodeFault.
class GcodeMachine {
 public:
  using Warn = std::function<void(const std::string&)>;

  GcodeMachine(const Scene& scene, GcodeParameters& parameters, MotionSink& sink, Warn warn);

  /// Executes a block in LinuxCNC's order. True if it ends the program (M2, M30).
  bool execute(GcodeBlock& block, std::size_t line);

 private:
  enum class FeedMode { kPerMinute, kInverseTime, kPerRevolution };
  enum class Motion { kNone, kRapid, kFeed, kClockwise, kCounterClockwise };
  /// Where the controlled point is, or should go.
  struct Position {
    Vec3 xyz;
    RotaryAngles angles;
    Vec3 axis{0, 0, 1};  ///< tool-vector machines
  };
  using Offset = std::array<double, 6>;  ///< X Y Z A B C

  void set_feed(GcodeBlock& block);
  void change_tool(GcodeBlock& block);
  void set_modes(GcodeBlock& block);
  void set_tool_length(GcodeBlock& block, int code);
  void set_tcp(bool by_length_code, bool by_m_code);
  void set_offsets(GcodeBlock& block);
  void shift_origin(GcodeBlock& block, int code);
  void go_home(GcodeBlock& block);
  void move(GcodeBlock& block);
  void rapid_in_machine_coordinates(GcodeBlock& block);
  void arc(GcodeBlock& block, const Position& target);
  void straight(const Position& target, double duration_s, bool rapid);

  Offset offset() const;
  double current(int axis) const;
  void refuse_foreign_axes(const GcodeBlock& block) const;
  Position read_target(GcodeBlock& block);
  Vec3 read_tool_axis(GcodeBlock& block);
  ArcCenter read_center(GcodeBlock& block, ArcPlane plane);
  /// Before the first cut since the tool was away: a rapid only brings it near and returns true; a
  /// cut starts where the rapids have led, with a warning unless X, Y and Z were `known`.
  bool approach(const Position& target, bool rapid, bool known);
  double feed_duration_s(const GcodeBlock& block, double length_mm, double turn_deg) const;
  ToolPose pose(const Position& position) const;
  bool tool_center_point() const { return tcp_by_length_code_ || tcp_by_m_code_; }
  double tool_length_mm() const;
  void publish_position();
  static void check(const MotionSink::Result& result);

  const Scene& scene_;
  GcodeParameters& parameters_;
  MotionSink& sink_;
  Warn warn_;
  std::size_t line_ = 0;

  Position at_;
  std::array<bool, 3> known_{};  ///< X, Y, Z have been programmed since the tool was away
  double unit_mm_ = 1;
  bool incremental_ = false;
  bool arc_absolute_ = false;
  FeedMode feed_mode_ = FeedMode::kPerMinute;
  double feed_ = 0;     ///< as written
  double feed_mm_ = 0;  ///< in mm
  double spindle_rpm_ = 0;
  Motion motion_ = Motion::kNone;
  ArcPlane plane_ = ArcPlane::kXy;
  int coordinate_system_ = 1;  ///< 1 to 9: G54 to G59.3
  std::array<Offset, 10> systems_{};
  Offset g92_{};
  bool g92_on_ = false;
  std::optional<ToolId> selected_;
  bool changed_tool_ = false;
  bool tcp_by_length_code_ = false;
  bool tcp_by_m_code_ = false;
};

}  // namespace kerf
