// SPDX-License-Identifier: Apache-2.0
// Canned cycles of GcodeMachine.
#include <cmath>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/machine.h"

namespace kerf {
namespace {

constexpr int kRepeatsMax = 1'000'000;

}  // namespace

CycleWords GcodeMachine::read_cycle(GcodeBlock& block, int code) const {
  for (const char letter : {'a', 'b', 'c'})
    if (const GcodeWord* word = block.find(letter))
      throw ProgramFault{word->text, "a canned cycle does not move rotary axes"};
  const std::string_view letters = plane_letters(modes_.plane);
  CycleWords words{.first = block.take(letters[0]),
                   .second = block.take(letters[1]),
                   .depth = block.take(letters[2]),
                   .distance = block.take('@'),
                   .angle_deg = block.take('^'),
                   .r = block.take('r'),
                   .p = block.take('p'),
                   .q = std::nullopt,
                   .i = std::nullopt,
                   .j = std::nullopt,
                   .k = std::nullopt};
  if (code == 730 || code == 830) words.q = block.take('q');
  if (setup_.rules.macros) {
    // Pecks, shifts and retracts do not change the hole.
    for (const char letter : {'q', 'i', 'j', 'k', 'e', 'd'}) block.take(letter);
  }
  if (code == 870) {
    const std::string_view offsets = modes_.plane == ArcPlane::kXy   ? "ijk"
                                     : modes_.plane == ArcPlane::kZx ? "kij"
                                                                     : "jki";
    words.i = block.take(offsets[0]);
    words.j = block.take(offsets[1]);
    words.k = block.take(offsets[2]);
  }
  if (const auto repeats = block.take('l')) {
    if (*repeats < (setup_.rules.macros ? 0 : 1) || *repeats > kRepeatsMax ||
        *repeats != std::floor(*repeats))
      throw ProgramFault{block.find('l')->text,
                         "the number of repeats must be an integer from 1 to 1000000"};
    words.repeats = static_cast<int>(*repeats);
  }
  return words;
}

void GcodeMachine::cycle(GcodeBlock& block, int code) {
  const GcodeCode* written = block.code(GcodeGroup::kMotion);
  if (compensation_.on())
    throw ProgramFault{
        written != nullptr ? written->text : "",
        "a canned cycle is not allowed while cutter compensation is on; program G40 first"};
  if (modes_.feed_mode == GcodeFeedMode::kInverseTime)
    throw ProgramFault{"", "a canned cycle is not allowed in inverse time mode (G93)"};
  const auto repeats = setup_.rules.macros ? block.find('l') : nullptr;
  if (repeats == nullptr || repeats->value != 0) require_feed(block);
  const ArcPlane plane = modes_.plane;
  if (beside_) return_to_path(block, at_);
  const CycleWords words = read_cycle(block, code);
  Named named = named_axes(block);
  named[plane == ArcPlane::kXy ? 2 : plane == ArcPlane::kZx ? 1 : 0] = true;
  const GcodeFeed speed =
      words.repeats == 0 ? GcodeFeed{.mm_per_min = 1, .deg_per_min = 1} : feed_of(block);
  running_ = RunningCycle{Cycle(code, modes_, in_plane(linear(at_), plane), words, cycle_), plane,
                          named, speed};
  modes_.motion = code;
}

bool GcodeMachine::go_on() {
  if (!running_) return next_of_pattern();
  const auto step = running_->cycle.next();
  if (!step) {
    set_linear(at_, from_plane(running_->cycle.end(), running_->plane));
    running_.reset();
    return next_of_pattern();
  }
  if (step->kind == CycleStep::Kind::kDwell) {
    count_call();
    canon_.dwell(step->seconds);
    return true;
  }
  GcodeAxes to = at_;
  set_linear(to, from_plane(step->to, running_->plane));
  if (step->kind == CycleStep::Kind::kRapid) {
    rapid(to, GcodeRapid::kPlain, running_->named);
  } else {
    feed(to, running_->speed, running_->named);
  }
  return true;
}

}  // namespace kerf
