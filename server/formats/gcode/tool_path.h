// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/formats/control/canon.h"
#include "server/formats/gcode/environment.h"
#include "server/formats/motion_sink.h"
#include "server/formats/scene.h"

namespace kerf {

/// Executes canonical calls on a scene's machine: converts them to tool poses in the workpiece and
/// appends the motions to a sink.
class GcodeToolPath final : public GcodeCanon {
 public:
  /// All arguments must outlive it.
  GcodeToolPath(const Scene& scene, const GcodeEnvironment& environment, MotionSink& sink);

  void at_line(std::size_t file, std::size_t line) override;
  void rapid(const GcodePlace& to, GcodeRapid kind, std::array<bool, 6> named) override;
  void feed(const GcodePlace& to, const GcodeFeed& feed, std::array<bool, 6> named) override;
  void arc(const Arc& arc, const GcodeFrame& frame, const GcodePlace& to, const GcodeFeed& feed,
           std::array<bool, 6> named) override;
  void spline(const std::vector<Vec3>& points, const GcodeFrame& frame, const GcodePlace& to,
              const GcodeFeed& feed, std::array<bool, 6> named) override;
  void dwell(double seconds) override;
  void select_tool(ToolId tool) override { selected_ = tool; }
  void change_tool(std::optional<ToolId> tool) override;
  void offset_tool(const GcodeAxes& offset, const GcodePlace& at) override;
  GcodePlace control_tool_center(bool on, const GcodePlace& at) override;
  void tilt(const std::optional<TiltedPlane>& plane) override;
  void remark(const MachineRemark& said) override { sink_.remark(said); }

 private:
  bool all_known() const { return known_[0] && known_[1] && known_[2]; }
  void check_turn(const GcodePlace& to) const;
  /// Until the first change, the operator has loaded what T selects.
  void load_selected();
  /// Handles motions while the tool is away from the workpiece. A rapid places the tool as soon as
  /// X, Y and Z are known, and returns true: it makes no motion. A cut starts at the current
  /// position, with a warning unless X, Y and Z are known.
  bool approach(const GcodePlace& to, bool rapid, std::array<bool, 6> named);
  void straight(const GcodePlace& to, double duration_s, bool rapid);
  double turn_deg(const GcodePlace& to) const;
  static double duration_s(const GcodeFeed& feed, double travel_mm, double turn_deg);
  /// Converts a position to a pose with the offsets and the control mode of a block. Paths keep a
  /// copy.
  struct PoseRule {
    Machine machine;
    bool tool_center;
    GcodeAxes excess;                ///< active offset minus that of the loaded tool
    std::optional<Vec3> plane_axis;  ///< of the tool in a tilted plane
    ToolPose operator()(const GcodePlace& place) const;
  };
  PoseRule poses() const {
    return {scene_.machine, tool_center_, offset_ - loaded_,
            plane_ ? std::optional(plane_->axes[2]) : std::nullopt};
  }
  ToolPose pose(const GcodePlace& place) const { return poses()(place); }
  GcodePlace in_workpiece(const GcodePlace& place) const;
  double tool_length_mm() const;
  static void check(const MotionSink::Result& result);

  const Scene& scene_;
  const ToolTable* table_;
  MotionSink& sink_;
  std::size_t line_ = 0;
  bool zero_known_;
  GcodeFrame workpiece_;  ///< work offset of G54 in the parameter file
  GcodePlace at_;
  std::array<bool, 3> known_{};  ///< X, Y, Z programmed since the tool was away
  bool changed_tool_ = false;
  std::optional<ToolId> selected_;  ///< by T, since the last motion
  bool tool_center_ = false;
  std::optional<TiltedPlane> plane_;
  bool tilted_since_ = false;  ///< the plane changed and X, Y and Z were not all programmed since
  GcodeAxes offset_{};         ///< active tool offset (G43)
  GcodeAxes loaded_{};         ///< tool table's offset of the loaded tool
};

}  // namespace kerf
