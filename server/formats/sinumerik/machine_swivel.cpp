// SPDX-License-Identifier: Apache-2.0
// CYCLE800 of SinumerikMachine: Siemens, "Programming cycles externally", 840D sl.
#include <cmath>
#include <string>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/sinumerik/machine.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

/// _MODE: axis by axis, about X, then about the turned Y, then about the turned Z.
constexpr double kAxesInTurn = 57;

// R = Rx Ry Rz, as columns.
std::array<Vec3, 3> turned_axes(double a_deg, double b_deg, double c_deg) {
  const double a = kRadPerDeg * a_deg, b = kRadPerDeg * b_deg, c = kRadPerDeg * c_deg;
  const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b),
               cc = std::cos(c), sc = std::sin(c);
  return {Vec3{cb * cc, ca * sc + sa * sb * cc, sa * sc - ca * sb * cc},
          Vec3{-cb * sc, ca * cc - sa * sb * sc, sa * cc + ca * sb * sc},
          Vec3{sb, -sa * cb, ca * cb}};
}

}  // namespace

// _FR, _TC, _ST, _MODE, _X0 _Y0 _Z0, _A _B _C, _X1 _Y1 _Z1, _DIR: the origin moves by X0 Y0 Z0, the
// plane turns, and moves by X1 Y1 Z1 within itself. The first argument retracts.
void SinumerikMachine::swivel(const std::vector<std::optional<double>>& given) {
  const auto value = [&given](std::size_t at) {
    return at < given.size() ? given[at].value_or(0) : 0.0;
  };
  constexpr std::size_t kFirst = 4, kLast = 12;
  bool any = false;
  for (std::size_t at = kFirst; at <= kLast; ++at) any = any || value(at) != 0;
  refuse_compensated("CYCLE800");
  if (value(0) != 0)
    canon_.rapid({at_, axis_}, GcodeRapid::kMachine, {false, false, true, false, false, false});
  const bool positions = value(13) != 0;
  if (!any) {
    // Without arguments the frames end, and the tables keep their position.
    swivel_open_ = tilted_ && !positions;
    if (std::exchange(tilted_, false)) {
      frame_ = {};
      for (std::size_t axis = 3; axis < 6; ++axis) at_[axis] = 0;
      canon_.tilt(std::nullopt);
    }
    return;
  }
  if (scene_.machine.kinematics == MachineKinematics::kXyz)
    throw ProgramFault{"CYCLE800", "swivels the plane, which the machine xyz cannot"};
  if (follows_tool_) throw ProgramFault{"CYCLE800", "while TRAORI is on is not supported"};
  if (value(3) != kAxesInTurn)
    throw ProgramFault{"CYCLE800", "is supported with _MODE 57 (about X, Y and Z in turn)"};
  if (std::fmod(std::abs(value(2)), 10) != 0)
    throw ProgramFault{"CYCLE800", "that adds to the active plane (_ST) is not supported"};
  if (!positions) throw ProgramFault{"CYCLE800", "without positioning (_DIR 0) is not supported"};
  TiltedPlane plane;
  plane.axes = turned_axes(value(7), value(8), value(9));
  plane.origin = Vec3{value(4), value(5), value(6)} * unit_mm_;
  for (std::size_t i = 0; i < 3; ++i)
    plane.origin = plane.origin + plane.axes[i] * (value(10 + i) * unit_mm_);
  frame_ = {};
  tilted_ = true;
  swivel_open_ = false;
  canon_.tilt(plane);
}

void SinumerikMachine::require_no_swivel() const {
  if (swivel_open_)
    throw ProgramFault{"CYCLE800",
                       "ended the plane and left the tables turned; swivel back to 0 (_DIR -1) "
                       "before a cut"};
}

}  // namespace kerf
