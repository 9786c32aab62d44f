// SPDX-License-Identifier: Apache-2.0
// Corners of SinumerikMachine between two lines of the active plane: RND= and RNDM= round them,
// CHF= (length of the chamfer) and CHR= (length along the lines) cut them.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/sinumerik/machine.h"

namespace kerf {
namespace {

constexpr double kLevelMm = 1e-9;

}  // namespace

// Removes the words of a corner. RNDM holds until RNDM=0.
void SinumerikMachine::read_corner(Words& words, Corner& corner) {
  const auto mm = [&](const char* name) {
    const SinumerikWord* word = take(words, name);
    if (word != nullptr && word->value < 0) throw ProgramFault{name, "must not be negative"};
    return word != nullptr ? std::optional(word->value * unit_mm_) : std::nullopt;
  };
  if (const auto modal = mm("RNDM")) modal_round_mm_ = *modal;
  corner.radius_mm = mm("RND").value_or(modal_round_mm_);
  corner.chamfer_mm = mm("CHF").value_or(0);
  corner.leg_mm = mm("CHR").value_or(0);
}

void SinumerikMachine::require_no_corner(const std::string& word) const {
  if (corner_ && !corner_->is_modal())
    throw ProgramFault{word, "behind RND, CHF and CHR, which a line (G1) must follow"};
}

// Makes the delayed line up to the corner unchanged.
void SinumerikMachine::release_corner() {
  if (!corner_) return;
  const Corner corner = *std::exchange(corner_, std::nullopt);
  go_straight(corner.at, corner.named, false, corner.feed);
}

// Makes the first line up to the corner, and the corner. The second line follows to `next`.
void SinumerikMachine::cut_corner(const GcodeAxes& next) {
  const Corner corner = *std::exchange(corner_, std::nullopt);
  const PlanePoint a = in_plane(linear(programmed()), plane_),
                   b = in_plane(linear(corner.at), plane_), c = in_plane(linear(next), plane_);
  const bool level =
      std::abs(a.normal - b.normal) <= kLevelMm && std::abs(c.normal - b.normal) <= kLevelMm;
  const double in = direction(a, b), out = direction(b, c);
  const double turn = std::remainder(out - in, 2 * std::numbers::pi);
  const double half = (std::numbers::pi - std::abs(turn)) / 2;
  const double reach = corner.leg_mm > 0       ? corner.leg_mm
                       : corner.chamfer_mm > 0 ? corner.chamfer_mm / (2 * std::sin(half))
                                               : corner.radius_mm / std::tan(half);
  const bool fits = level && reach <= std::min(distance(a, b), distance(b, c)) + kLevelMm;
  if (!fits && !corner.is_modal())
    throw ProgramFault{"RND", level ? "RND, CHF or CHR is larger than one of its lines"
                                    : "RND, CHF and CHR require two lines within the active plane"};
  if (!fits || std::abs(turn) < 1e-9)
    return go_straight(corner.at, corner.named, false, corner.feed);
  const PlanePoint start = offset_point(b, -reach, in), end = offset_point(b, reach, out);
  GcodeAxes to = corner.at;
  set_linear(to, from_plane(start, plane_));
  go_straight(to, corner.named, false, corner.feed);
  set_linear(to, from_plane(end, plane_));
  if (corner.leg_mm > 0 || corner.chamfer_mm > 0)
    return go_straight(to, corner.named, false, corner.feed);
  const double side = turn > 0 ? 1 : -1;
  const PlanePoint center = offset_point(start, corner.radius_mm, in + side * std::numbers::pi / 2);
  go_round(to, corner.named, center, turn < 0, 1, corner.feed);
}

}  // namespace kerf
