// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/formats/control/compensation.h"
#include "server/formats/control/plane.h"
#include "server/formats/machine_kinematics.h"
#include "server/formats/motion_sink.h"

namespace kerf {

/// The coordinates of a Klartext program: a datum shift, a rotation in XY about the datum (cycle
/// 10), and the tilted plane about the datum.
struct KlartextFrame {
  Vec3 datum_mm{0, 0, 0};
  double rotation_deg = 0;
  std::array<Vec3, 3> tilted{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< axes of the plane
  bool is_tilted = false;

  Vec3 in_workpiece(Vec3 programmed) const;
  Vec3 programmed(Vec3 in_workpiece) const;
};

/// Approach to the first point of a contour, by APPR or by a line with RL or RR.
struct KlartextApproach {
  enum class Kind { kDirect, kTangent, kNormal, kArc, kLineAndArc };  ///< a line, LT, LN, CT, LCT
  Kind kind = Kind::kTangent;
  Vec3 contour{0, 0, 0};  ///< the point
  double level = 0;       ///< its height before moves along Z
  double length_mm = 0;   ///< LEN
  double radius_mm = 0;   ///< of the path of the tool's center; < 0: on the other side
  double angle_deg = 0;   ///< CCA
  int side = 0;           ///< of the contour: RL 1, RR -1
  double offset_mm = 0;   ///< the tool's radius
  double feed = 0;        ///< mm per minute
  bool is_rapid = false;  ///< up to the last line or arc
};

/// The tool of a Klartext program: its motions in the workpiece. Errors are ProgramFault.
class KlartextPath {
 public:
  using Warn = std::function<void(const std::string&)>;
  KlartextPath(const Scene& scene, MotionSink& sink, Warn warn)
      : scene_(scene),
        sink_(sink),
        warn_(std::move(warn)),
        compensation_([this](const CompensatedMove& move) { emit(move); }) {}

  const KlartextFrame& frame() const { return frame_; }
  /// Returns the frame for changes. Not while the path is compensated.
  KlartextFrame& changing_frame() {
    require_uncompensated();
    return frame_;
  }
  bool is_tilted() const { return frame_.is_tilted; }
  /// Whether Z of the program is the axis of the tool.
  bool is_axis_z() const;
  void at_line(std::size_t line) { line_ = line; }
  void change_tool(std::optional<ToolId> tool);
  std::optional<ToolId> tool() const { return sink_.tool(); }
  /// The tool leaves the workpiece along its axis, to the limit of the machine.
  void retract();
  /// Moves an axis, 0 to 2, to a machine position, whose workpiece coordinate is unknown.
  void lose(std::size_t axis);
  void set_tool_center(bool on) {
    require_uncompensated();
    tool_center_ = on;
  }
  bool has_tool_center() const { return tool_center_; }
  /// The tool axis becomes the normal of the tilted plane, or vertical.
  void align();

  /// The programmed point, which is on the contour while the tool is offset from it.
  Vec3 position() const;
  /// After R0 the tool stays offset from the contour until it moves in X and Y, which start here.
  Vec3 contour() const;
  /// RL (1), RR (-1) and R0 (0) in the plane XY. With `offset_mm` 0 the path is that of the center.
  void compensate(int side, double offset_mm);
  bool is_compensated() const { return compensation_.on() || approach_; }
  int side() const { return approach_ ? approach_->side : compensation_.side(); }
  /// Approaches a contour as soon as its first move is known. position() is then on the contour.
  void approach_later(const KlartextApproach& approach) {
    require_uncompensated();
    beside_.reset();
    approach_ = approach;
  }
  /// Makes the move that compensation delays.
  void finish();
  RotaryAngles angles() const { return angles_; }
  /// Adds whole turns to the angle of A, B or C, so that it is within 180 degrees of `near_deg`.
  void count_angle(char axis, double near_deg);
  /// Removes whole turns from the angles of `axes`: C is then from 0 to 360 degrees; A and B, which
  /// tilt, keep their sign.
  void reduce_angles(std::string_view axes);
  /// Moves to programmed coordinates. `named` are the linear axes that the block names.
  void line(Vec3 to, const RotaryAngles& angles, std::optional<double> feed_mm_per_min,
            std::array<bool, 3> named);
  /// The same, while the tool turns to an axis in the workpiece: tables by their angles, a machine
  /// `tool-vector` along the great circle. Not while the path is compensated or the plane tilted.
  void line(Vec3 to, Vec3 axis, std::optional<double> feed_mm_per_min, std::array<bool, 3> named);
  /// Moves on an arc about a center; `turns` as for arc_about (control/arc.h).
  void arc(Vec3 to, ArcPlane plane, Vec3 center, int turns, double feed_mm_per_min);
  void dwell(double seconds);
  void remark(MachineRemark said) { sink_.remark(std::move(said)); }

 private:
  void move_line(Vec3 to, const RotaryAngles& angles, std::optional<double> feed_mm_per_min,
                 std::array<bool, 3> named);
  void move_arc(Vec3 to, ArcPlane plane, Vec3 center, int turns, double feed_mm_per_min);
  CompensatedInfo info_of(std::optional<double> feed_mm_per_min, std::array<bool, 3> named) const;
  void emit(const CompensatedMove& move);
  void require_uncompensated() const;
  void approach_by_line(Vec3 to, std::optional<double> feed_mm_per_min);
  void finish_approach();
  void begin_contour(Vec3 tangent);
  double& angle(char axis);
  /// Converts a tip in the workpiece to a pose with the control mode of a block. Paths keep a copy.
  struct PoseRule {
    Machine machine;
    bool follows_tables, tool_center;
    Vec3 plane_axis;
    ToolPose operator()(Vec3 tip_mm, const RotaryAngles& angles) const;
  };
  PoseRule poses() const;
  ToolPose pose(Vec3 tip_mm, const RotaryAngles& angles) const { return poses()(tip_mm, angles); }
  bool approach(const ToolPose& to, bool rapid, std::array<bool, 3> named);
  static void check(const MotionSink::Result& result);

  const Scene& scene_;
  MotionSink& sink_;
  Warn warn_;
  KlartextFrame frame_;
  Vec3 tip_mm_{0, 0, 0};  ///< in the workpiece, if known
  RotaryAngles angles_;
  Vec3 plane_axis_{0, 0, 1};  ///< of the tool, if no tables turn or the plane is tilted
  std::array<bool, 3> known_{};
  bool tool_center_ = false, changed_tool_ = false;
  std::size_t line_ = 0;
  CutterCompensation compensation_;
  Vec3 center_{0, 0, 0};  ///< of the tool while it is compensated, programmed
  struct Lift {
    double z = 0;
    std::optional<double> feed;
  };
  std::vector<Lift> lifts_;                   ///< moves along Z after the approach
  double offset_mm_ = 0;                      ///< of RL and RR
  std::optional<KlartextApproach> approach_;  ///< to be made
  std::optional<PlanePoint> beside_;  ///< the contour's point at which R0 left the tool offset
};

}  // namespace kerf
