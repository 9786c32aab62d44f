// SPDX-License-Identifier: Apache-2.0
// Tilted planes of KlartextMachine.
#include <algorithm>
#include <cmath>
#include <utility>

#include "server/formats/heidenhain/machine.h"
#include "server/formats/units.h"

namespace kerf {

void KlartextMachine::reset_plane() {
  KlartextFrame& frame = path_.changing_frame();
  if (std::exchange(frame.is_tilted, false)) path_.align();
}

// PLANE RESET, PLANE SPATIAL SPA SPB SPC and PLANE VECTOR BX BY BZ NX NY NZ.
void KlartextMachine::tilt(const std::string& text) {
  const std::size_t end = std::min(text.find(' '), text.size());
  const std::string kind = text.substr(0, end);
  if (kind == "RESET") return reset_plane();
  const bool spatial = kind == "SPATIAL";
  if (!spatial && kind != "VECTOR")
    throw ProgramFault{"PLANE " + kind, "is not supported; use PLANE SPATIAL"};
  const Words words = klartext_words(std::string_view(text).substr(end));
  if (path_.frame().rotation_deg != 0)
    throw ProgramFault{"PLANE", "with an active rotation (cycle 10) is not supported"};
  const bool positions = std::ranges::any_of(
      words, [](const KlartextWord& word) { return word.name == "TURN" || word.name == "MOVE"; });
  if (spatial) {
    tilt_by_angles(words);
  } else {
    tilt_by_vectors(words);
  }
  finish_tilt(positions);
}

// The angles turn about the fixed X, Y and Z in sequence.
void KlartextMachine::tilt_by_angles(const Words& words) {
  double angle[3] = {0, 0, 0};
  for (const KlartextWord& word : words)
    for (int i = 0; i < 3; ++i)
      if (word.name == std::string("SP") + "ABC"[i]) angle[i] = kRadPerDeg * values_.of(word.value);
  for (int column = 0; column < 3; ++column) {
    Vec3 v{column == 0 ? 1.0 : 0, column == 1 ? 1.0 : 0, column == 2 ? 1.0 : 0};
    const double ca = std::cos(angle[0]), sa = std::sin(angle[0]);
    v = {v.x, ca * v.y - sa * v.z, sa * v.y + ca * v.z};
    const double cb = std::cos(angle[1]), sb = std::sin(angle[1]);
    v = {cb * v.x + sb * v.z, v.y, -sb * v.x + cb * v.z};
    const double cc = std::cos(angle[2]), sc = std::sin(angle[2]);
    path_.changing_frame().tilted[static_cast<std::size_t>(column)] = {cc * v.x - sc * v.y,
                                                                       sc * v.x + cc * v.y, v.z};
  }
}

// N is the normal of the plane; its X axis is the part of B within it.
void KlartextMachine::tilt_by_vectors(const Words& words) {
  Vec3 base{0, 0, 0}, normal{0, 0, 0};
  for (const KlartextWord& word : words) {
    if (word.name.size() != 2 || word.value.empty()) continue;
    Vec3& v = word.name[0] == 'B' ? base : normal;
    if (word.name[0] != 'B' && word.name[0] != 'N') continue;
    if (word.name[1] == 'X') v.x = values_.of(word.value);
    if (word.name[1] == 'Y') v.y = values_.of(word.value);
    if (word.name[1] == 'Z') v.z = values_.of(word.value);
  }
  if (!(length(normal) > kVectorMin)) throw ProgramFault{"PLANE VECTOR", "requires NX, NY and NZ"};
  const Vec3 z = normalized(normal);
  const Vec3 within = base - z * dot(base, z);
  if (!(length(within) > kVectorMin))
    throw ProgramFault{"PLANE VECTOR", "requires BX, BY and BZ beside the normal"};
  const Vec3 x = normalized(within);
  path_.changing_frame().tilted = {x, cross(z, x), z};
}

void KlartextMachine::finish_tilt(bool positions) {
  KlartextFrame& frame = path_.changing_frame();
  const bool level = frame.tilted[0] == Vec3{1, 0, 0} && frame.tilted[2] == Vec3{0, 0, 1};
  if (level && !frame.is_tilted) return;
  if (!positions)
    throw ProgramFault{"STAY", "leaves the tool as it was, which is not supported; use TURN"};
  if (scene_.machine.kinematics == MachineKinematics::kXyz)
    throw ProgramFault{"PLANE", "tilts the plane, which the machine xyz cannot"};
  frame.is_tilted = true;
  path_.align();
  direction_.reset();
}

}  // namespace kerf
