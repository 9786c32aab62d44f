// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kernel/sculpture.h"
#include "server/formats/control/arc.h"
#include "server/formats/control/axes.h"
#include "server/formats/machine_remark.h"

namespace kerf {

/// A position of the controlled point in absolute coordinates: work offsets and G92 removed.
struct GcodePlace {
  GcodeAxes axes{};
  Vec3 tool_axis{0, 0, 1};  ///< set if GcodeSetup::tool_axis_words; any length
};

/// The feed of a cutting motion.
struct GcodeFeed {
  double mm_per_min = 0;   ///< along X, Y and Z
  double deg_per_min = 0;  ///< if X, Y and Z are at rest: along A, B and C
  double duration_s = 0;   ///< if > 0: duration of the whole motion, overriding both (G93)
};

/// A plane of programmed coordinates: its unit axes, and its origin, mm, in the workpiece. The tool
/// is along the third axis.
struct TiltedPlane {
  std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 origin{0, 0, 0};
};

/// Kinds of rapid motion.
enum class GcodeRapid {
  kPlain,   ///< G0 in the work coordinate system
  kMachine  ///< to machine coordinates (G53, G28, G30)
};

/// The canonical machining functions that the RS-274 interpreter calls, in order of execution. The
/// terms are those of LinuxCNC and NIST RS274NGC. Implement this interface to receive the motions
/// of a program from run_gcode. An implementation throws ProgramFault for a call that it cannot
/// execute. `named` marks the axes for which the block has a word.
class GcodeCanon {
 public:
  virtual ~GcodeCanon() = default;
  GcodeCanon() = default;
  GcodeCanon(const GcodeCanon&) = delete;
  GcodeCanon& operator=(const GcodeCanon&) = delete;

  /// Receives the warnings of an implementation. The interpreter sets it and adds file and line.
  using Warn = std::function<void(const std::string&)>;
  void set_warn(Warn warn) { warn_ = std::move(warn); }

  /// Sets the origin of the following calls: a line (from 1) of a file (0: the program itself).
  virtual void at_line(std::size_t file, std::size_t line) = 0;
  /// Rapid motion (traverse). If the machine zero is not known, the target of a kMachine rapid has
  /// no position in the workpiece.
  virtual void rapid(const GcodePlace& to, GcodeRapid kind, std::array<bool, 6> named) = 0;
  /// Straight cutting motion.
  virtual void feed(const GcodePlace& to, const GcodeFeed& feed, std::array<bool, 6> named) = 0;
  /// Circular or helical cutting motion. `arc` is in programmed coordinates, which `frame` converts
  /// to those of `to`.
  virtual void arc(const Arc& arc, const GcodeFrame& frame, const GcodePlace& to,
                   const GcodeFeed& feed, std::array<bool, 6> named) = 0;
  /// Cutting motion along a Bézier curve that starts at the controlled point. `points` are the
  /// other two or three control points in programmed coordinates. The last one is `to`.
  virtual void spline(const std::vector<Vec3>& points, const GcodeFrame& frame,
                      const GcodePlace& to, const GcodeFeed& feed, std::array<bool, 6> named) = 0;
  /// Rest for `seconds` >= 0.
  virtual void dwell(double seconds) = 0;
  /// T: the tool of the next change. Ignored unless it is overridden.
  virtual void select_tool(ToolId) {}
  /// Tool change; nullopt leaves the spindle empty.
  virtual void change_tool(std::optional<ToolId> tool) = 0;
  /// Sets the active tool offset (G43 and its variants). The controlled point does not move. Its
  /// new coordinates are `at`.
  virtual void offset_tool(const GcodeAxes& offset, const GcodePlace& at) = 0;
  /// Switches tool-center-point control. The controlled point does not move. Returns its new
  /// coordinates.
  virtual GcodePlace control_tool_center(bool on, const GcodePlace& at) = 0;
  /// Tilts the plane of the following positions; nullopt ends that. The tool is away from the
  /// workpiece until X, Y and Z have been programmed. Ignored unless overridden.
  virtual void tilt(const std::optional<TiltedPlane>&) {}
  /// Spindle, coolant, stops and comments. Ignored unless it is overridden.
  virtual void remark(const MachineRemark&) {}

 protected:
  /// Reports a warning.
  void warn(const std::string& text) const {
    if (warn_) warn_(text);
  }

 private:
  Warn warn_;
};

}  // namespace kerf
