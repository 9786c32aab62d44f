// SPDX-License-Identifier: Apache-2.0
// Rotation (G68), scaling (G51) and mirror images (G51.1, G101) of GcodeMachine. They change the
// frame between programmed and absolute coordinates, so that arcs, cycles and compensation follow.
#include <algorithm>
#include <cmath>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/machine.h"

namespace kerf {
namespace {

constexpr double kSameCenterMm = 1e-9;
// A factor without a point is in thousandths. Unlikely values are rejected.
constexpr double kThousandthsMin = 100;

double factor_of(const GcodeWord& word) {
  if (word.text.find('.') != std::string::npos) return word.value;
  if (std::abs(word.value) < kThousandthsMin)
    throw ProgramFault{word.text, "is ambiguous: write the factor with a point"};
  return word.value / 1000;
}

// G69, G50, G50.1, G100.
bool ends_transform(int code) { return code == 690 || code == 500 || code == 501 || code == 1000; }

}  // namespace

void GcodeMachine::transform(GcodeBlock& block) {
  if (untransformed_) {
    const GcodeCode* special = block.code(GcodeGroup::kNonModal);
    if (special == nullptr || special->code == 40 || special->code == 530 || special->code == 280 ||
        special->code == 300)
      special = block.code(GcodeGroup::kShiftApplied);
    if (special != nullptr)
      throw ProgramFault{special->text,
                         "is not allowed while the program is rotated, scaled or mirrored"};
  }
  for (const GcodeGroup group :
       {GcodeGroup::kRotation, GcodeGroup::kScaling, GcodeGroup::kMirror}) {
    const GcodeCode* code = block.code(group);
    if (code == nullptr) continue;
    const bool ends = ends_transform(code->code);
    if (ends && group == GcodeGroup::kMirror) take_mirror_end(block, *code);
    // The end of another transformation leaves the active one as it is.
    if (ends && (!untransformed_ || transform_group_ != group)) continue;
    const bool of_mach3 = setup_.rules.dialect == Dialect::kMach3 && group == GcodeGroup::kRotation;
    if (!setup_.rules.of_fanuc() && !of_mach3)
      throw ProgramFault{code->text, "is not supported; its words differ between controls"};
    reject_compensated(*code);
    require_no_corner();
    if (ends && group != GcodeGroup::kMirror) {
      end_transform();
    } else if (group == GcodeGroup::kRotation) {
      rotate_program(block);
    } else if (group == GcodeGroup::kScaling) {
      scale_program(block);
    } else {
      mirror_program(block, code->code);
    }
    if (!ends) transform_group_ = group;
  }
}

void GcodeMachine::end_transform() {
  set_transform(*untransformed_);
  untransformed_.reset();
}

// Installs a frame. The machine does not move. The coordinates of its position change.
void GcodeMachine::set_transform(const GcodeFrame& frame) {
  const GcodeAxes before = at_;
  change_frame(frame);
  transform_moved_ =
      std::abs(at_[0] - before[0]) > kSameCenterMm || std::abs(at_[1] - before[1]) > kSameCenterMm;
}

void GcodeMachine::rotate_program(GcodeBlock& block) {
  const GcodeCode& written = *block.code(GcodeGroup::kRotation);
  if (modes_.plane != ArcPlane::kXy)
    throw ProgramFault{written.text, "is supported in the plane XY (G17) only"};
  if (frame_.scale != GcodeFrame{}.scale)
    throw ProgramFault{written.text, "is not supported together with scaling or a mirror image"};
  if (modes_.incremental || block.has_any("zijk"))
    throw ProgramFault{written.text, "is supported with G90 and X, Y and R only"};
  const GcodeFrame base = untransformed_.value_or(frame_);
  const GcodeAxes here = base.programmed(frame_.absolute(at_));
  const auto x = block.take('x');
  const auto y = block.take('y');
  const auto angle = block.take('r');
  if (!angle) throw ProgramFault{written.text, "requires R, the angle in degrees"};
  const double cx = x ? *x * modes_.unit_mm : here[0];
  const double cy = y ? *y * modes_.unit_mm : here[1];
  // Turned about c, then shifted, then the system's own rotation.
  GcodeFrame frame = base;
  frame.rotation_deg += *angle;
  frame.shift[0] += cx;
  frame.shift[1] += cy;
  turn_xy(frame.shift[0], frame.shift[1], -*angle);
  frame.shift[0] -= cx;
  frame.shift[1] -= cy;
  set_transform(frame);
  untransformed_ = base;
  block_motion_ = -1;
}

void GcodeMachine::scale_program(GcodeBlock& block) {
  const GcodeCode& written = *block.code(GcodeGroup::kScaling);
  if (untransformed_)
    throw ProgramFault{written.text,
                       "is not supported while the program is already rotated, scaled "
                       "or mirrored; cancel that first"};
  GcodeFrame frame = frame_;
  const GcodeWord* common = block.find('p');
  block.take('p');
  for (std::size_t i = 0; i < 3; ++i) {
    const GcodeWord* factor = common != nullptr ? common : block.find("ijk"[i]);
    block.take("ijk"[i]);
    const auto center = block.take(kAxisLetters[i]);
    if (factor == nullptr) continue;
    const double s = factor_of(*factor);
    if (s == 0) throw ProgramFault{factor->text, "must not be 0"};
    if (i == 2 && s != 1)
      throw ProgramFault{factor->text, "scales Z, which is not supported; give I and J"};
    if (!center && s != 1)
      throw ProgramFault{written.text, "requires X and Y, the center of the scaling"};
    frame.scale[i] = s;
    frame.shift[i] += center.value_or(0) * modes_.unit_mm * (1 - s);
  }
  const GcodeFrame base = frame_;
  set_transform(frame);
  untransformed_ = base;
  block_motion_ = -1;
}

// The axes of G50.1 and G100 are not a target.
void GcodeMachine::take_mirror_end(GcodeBlock& block, const GcodeCode& code) {
  if (!block.has_any("xyzabc")) return;
  if (block.code(GcodeGroup::kMotion) != nullptr)
    throw ProgramFault{code.text, "with axes requires a block without a motion code"};
  block.take('x');
  block.take('y');
  block_motion_ = -1;
}

// G51.1 X0: X is mirrored at X0. G50.1 and G100 cancel the mirror of their axes, or of all.
void GcodeMachine::mirror_program(GcodeBlock& block, int code) {
  const GcodeCode& written = *block.code(GcodeGroup::kMirror);
  if (block.has_any("zabc")) throw ProgramFault{written.text, "is supported for X and Y only"};
  if (ends_transform(code)) {
    const bool x = block.find('x') != nullptr, y = block.find('y') != nullptr;
    const bool keeps_x = frame_.scale[0] < 0 && !x && y, keeps_y = frame_.scale[1] < 0 && !y && x;
    if (keeps_x && frame_.scale[1] > 0) return;
    if (keeps_y && frame_.scale[0] > 0) return;
    if (keeps_x || keeps_y)
      throw ProgramFault{written.text, "is supported for all mirrored axes at once only"};
    end_transform();
  } else {
    if (untransformed_)
      throw ProgramFault{written.text,
                         "is not supported while the program is already rotated, "
                         "scaled or mirrored; give all axes in one block"};
    GcodeFrame frame = frame_;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto at = block.take(kAxisLetters[i]);
      if (!at) continue;
      frame.scale[i] = -1;
      frame.shift[i] += 2 * *at * modes_.unit_mm;
    }
    const GcodeFrame base = frame_;
    set_transform(frame);
    untransformed_ = base;
    block_motion_ = -1;
  }
}

// Controls disagree about coordinates that the next block omits.
void GcodeMachine::check_after_transform(const GcodeBlock& block) {
  if (!transform_moved_) return;
  const bool x = block.has_any("x@"), y = block.has_any("y^");
  if (!x && !y) return;
  const GcodeCode* special = block.code(GcodeGroup::kNonModal);
  const bool away = special != nullptr && (special->code == 280 || special->code == 300);
  if (!away && (!x || !y || modes_.incremental))
    throw ProgramFault{"",
                       "the first move after a rotation, scaling or mirror image must name both X "
                       "and Y with G90"};
  transform_moved_ = false;
}

}  // namespace kerf
