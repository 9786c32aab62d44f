// SPDX-License-Identifier: Apache-2.0
// Corners of SinumerikMachine between two lines of the active plane: RND= and RNDM= round them,
// CHF= (length of the chamfer) and CHR= (length along the lines) cut them.
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/sinumerik/machine.h"

namespace kerf {

// Removes the words of a corner. RNDM holds until RNDM=0.
void SinumerikMachine::read_corner(Words& words, Corner& corner) {
  const auto mm = [&](const char* name) {
    const SinumerikWord* word = take(words, name);
    if (word != nullptr && word->value < 0) throw ProgramFault{name, "must not be negative"};
    return word != nullptr ? std::optional(word->value * unit_mm_) : std::nullopt;
  };
  if (const auto modal = mm("RNDM")) modal_round_mm_ = *modal;
  corner.size = {.radius_mm = mm("RND").value_or(modal_round_mm_),
                 .chamfer_mm = mm("CHF").value_or(0),
                 .leg_mm = mm("CHR").value_or(0)};
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
  const auto path =
      corner_path(in_plane(linear(programmed()), plane_), in_plane(linear(corner.at), plane_),
                  in_plane(linear(next), plane_), corner.size);
  if (!path && !corner.is_modal())
    throw ProgramFault{"RND", path.error() == CornerFault::kTooLarge
                                  ? "RND, CHF or CHR is larger than one of its lines"
                                  : "RND, CHF and CHR require two lines within the active plane"};
  if (!path || path->straight_on) return go_straight(corner.at, corner.named, false, corner.feed);
  GcodeAxes to = corner.at;
  set_linear(to, from_plane(path->start, plane_));
  go_straight(to, corner.named, false, corner.feed);
  set_linear(to, from_plane(path->end, plane_));
  if (!path->center) return go_straight(to, corner.named, false, corner.feed);
  go_round(to, corner.named, *path->center, path->turns < 0, 1, corner.feed);
}

}  // namespace kerf
