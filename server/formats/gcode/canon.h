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
#include "server/formats/gcode/arc.h"
#include "server/formats/gcode/axes.h"

namespace kerf {

/// Where the controlled point is, or goes: without offsets of coordinate systems and of G92.
struct GcodePlace {
  GcodeAxes axes{};
  Vec3 tool_axis{0, 0, 1};  ///< only machines whose programs give it (I J K on G0 and G1)
};

/// How fast a cut goes. Where X, Y and Z rest, the rotary axes' speed counts.
struct GcodeFeed {
  double mm_per_min = 0;
  double deg_per_min = 0;
  double duration_s = 0;  ///< where > 0: the time of the whole motion, whatever its length (G93)
};

/// What a rapid is for.
enum class GcodeRapid { kPlain, kMachine };

/// What an interpreter of RS-274 asks a machine to do, in order; LinuxCNC calls these canonical
/// functions. The file and line of each call are told before it. An implementation throws
/// GcodeFault for what it cannot do.
class GcodeCanon {
 public:
  virtual ~GcodeCanon() = default;
  GcodeCanon() = default;
  GcodeCanon(const GcodeCanon&) = delete;
  GcodeCanon& operator=(const GcodeCanon&) = delete;

  /// Who is told what is worth a warning; the interpreter adds where.
  using Warn = std::function<void(const std::string&)>;
  void set_warn(Warn warn) { warn_ = std::move(warn); }

  /// The calls that follow come from this line (from 1) of this file (0 is the program itself).
  virtual void at_line(std::size_t file, std::size_t line) = 0;
  /// `known` tells which axes the program has named in this block. A kMachine rapid goes to
  /// machine coordinates (G53, G28, G30), which mean nothing in the workpiece where the machine's
  /// zero is not known.
  virtual void rapid(const GcodePlace& to, GcodeRapid kind, std::array<bool, 6> named) = 0;
  virtual void feed(const GcodePlace& to, const GcodeFeed& feed, std::array<bool, 6> named) = 0;
  /// `arc` is in programmed coordinates, which `frame` brings to those of `to`.
  virtual void arc(const Arc& arc, const GcodeFrame& frame, const GcodePlace& to,
                   const GcodeFeed& feed, std::array<bool, 6> named) = 0;
  /// A Bézier curve from where the controlled point is: `points` are its other control points (two
  /// or three), in programmed coordinates; the last one is `to`.
  virtual void spline(const std::vector<Vec3>& points, const GcodeFrame& frame,
                      const GcodePlace& to, const GcodeFeed& feed, std::array<bool, 6> named) = 0;
  virtual void dwell(double seconds) = 0;
  /// None: the spindle is empty from now on.
  virtual void change_tool(std::optional<ToolId> tool) = 0;
  /// The offset of the tool in force is another from now on: the controlled point, which does not
  /// move, is at `at`.
  virtual void offset_tool(const GcodeAxes& offset, const GcodePlace& at) = 0;
  /// Tool-centre-point control goes on or off: where the controlled point, which does not move, is
  /// from now on.
  virtual GcodePlace control_tool_center(bool on, const GcodePlace& at) = 0;

 protected:
  void warn(const std::string& text) const {
    if (warn_) warn_(text);
  }

 private:
  Warn warn_;
};

}  // namespace kerf
