// SPDX-License-Identifier: Apache-2.0
// Frames of SinumerikMachine, and the control that follows the tool.
#include <cmath>

#include "server/formats/control/fault.h"
#include "server/formats/sinumerik/machine.h"

namespace kerf {

// TRANS, ATRANS, ROT and AROT, each a block of its own.
bool SinumerikMachine::frame_statement(const std::string& text) {
  for (const std::string_view word : {"SCALE", "ASCALE", "MIRROR", "AMIRROR", "ROTS", "AROTS",
                                      "CROTS", "TOROT", "TOFRAME", "PAROT"})
    if (begins_word(text, word))
      throw ProgramFault{std::string(word), "is not supported; post the motions in the workpiece"};
  for (const std::string_view word : {"TRANS", "ATRANS", "ROT", "AROT"}) {
    if (!begins_word(text, word)) continue;
    refuse_compensated(std::string(word));
    Words words = sinumerik_words(std::string_view(text).substr(word.size()), values_);
    const bool adds = word.starts_with('A');
    if (word.ends_with("TRANS")) {
      shift(words, adds);
    } else {
      rotate(words, adds);
    }
    for (const SinumerikWord& one : words)
      if (!one.used) throw ProgramFault{one.name, "is not a word of " + std::string(word)};
    return true;
  }
  return false;
}

// TRANS ends all frames of the program; ATRANS shifts within them.
void SinumerikMachine::shift(Words& words, bool adds) {
  GcodeAxes by{};
  for (SinumerikWord& word : words) {
    const std::size_t axis = std::string_view("XYZ").find(word.name);
    if (word.name.size() != 1 || axis == std::string_view::npos) continue;
    by[axis] = word.value * unit_mm_;
    word.used = true;
  }
  const GcodeFrame before = frame_;
  if (!adds) frame_ = {};
  frame_.origin = adds ? before.absolute(by) : by;
  for (std::size_t i = 3; i < 6; ++i) frame_.origin[i] = 0;
}

// ROT Z… and ROT RPL=… in XY. About another axis the plane would tilt.
void SinumerikMachine::rotate(Words& words, bool adds) {
  if (!adds) frame_ = {};
  for (SinumerikWord& word : words) {
    if (word.name == "RPL" && plane_ != ArcPlane::kXy)
      throw ProgramFault{"RPL", "is supported in the plane XY (G17) only"};
    const bool about_z = word.name == "Z" || word.name == "RPL";
    if (!about_z && word.value != 0)
      throw ProgramFault{word.name,
                         "tilts the plane, which is not supported; post the motions in "
                         "the workpiece"};
    if (about_z) frame_.rotation_deg += word.value;
    word.used = true;
  }
}

// The machine does not move. The coordinates of its position change.
void SinumerikMachine::follow_tool(bool on) {
  if (on && scene_.machine.kinematics == MachineKinematics::kXyz)
    throw ProgramFault{"TRAORI",
                       "requires a scene whose machine is xyzac-trt, xyzbc-trt or "
                       "tool-vector"};
  refuse_compensated("TRAORI");
  if (on && tilted_) throw ProgramFault{"TRAORI", "in a plane of CYCLE800 is not supported"};
  follows_tool_ = on;
  at_ = canon_.control_tool_center(on, {at_, axis_}).axes;
}

}  // namespace kerf
