// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/cycle.h"

#include <cmath>
#include <string>

#include "server/formats/control/fault.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

// Clearance above the last peck at which pecking cycles change from rapid to feed (0.01 inch).
constexpr double kPeckClearanceMm = 0.254;
// A peck deeper than any hole, in any unit: G83 without Q on a Haas.
constexpr double kOnePeck = 1e6;
constexpr double kDecimals = 1e7;

/// Converts mm to program units: the coordinate at which the last cycle ended if it matches, else a
/// short decimal as programs have them, else the quotient.
double units_of(double mm, double unit_mm, double last) {
  if (last * unit_mm == mm) return last;
  const double quotient = mm / unit_mm;
  const double decimal = std::round(quotient * kDecimals) / kDecimals;
  return decimal * unit_mm == mm ? decimal : quotient;
}

}  // namespace

Cycle::Cycle(int code, const GcodeModes& modes, PlanePoint at, const CycleWords& words,
             CycleMemory& memory)
    : code_(code),
      modes_(modes),
      words_(words),
      memory_(&memory),
      repeated_(memory.lenient ? memory.code != 0 : memory.code == code),
      end_{units_of(at.first, modes.unit_mm, memory.end.first),
           units_of(at.second, modes.unit_mm, memory.end.second),
           units_of(at.normal, modes.unit_mm, memory.end.normal)} {
  recall();
  level_ = end_.normal;
  if (!memory_->initial_level) memory_->initial_level = level_;
  memory_->code = code_;
  recall_heights(*memory_->initial_level);
  if (words_.repeats == 0) return;  // the words are stored for the blocks that follow
  double initial = *memory_->initial_level;
  set_heights(initial);
  if (initial < r_) {
    rapid({end_.first, end_.second, r_});
    initial = level_ = r_;
  }
  clear_ = modes_.retract_to_r ? r_ : initial;
  hole_ = {end_.first, end_.second, 0};
  if (!modes_.incremental) set_hole();
}

PlanePoint Cycle::in_mm(PlanePoint point) const {
  const double mm = modes_.unit_mm;
  return {point.first * mm, point.second * mm, point.normal * mm};
}

std::optional<CycleStep> Cycle::next() {
  while (steps_.empty()) {
    if (peck_) {
      peck();
    } else if (holes_ < words_.repeats) {
      begin_hole();
    } else {
      memory_->end = end_;
      return std::nullopt;
    }
  }
  const CycleStep step = steps_.front();
  steps_.pop_front();
  return step;
}

void Cycle::begin_hole() {
  if (modes_.incremental) advance_hole();
  if (holes_++ == 0 && level_ > r_) {
    rapid_to(level_);
    rapid_to(r_);
  } else {
    rapid_to(clear_);
    if (clear_ > r_) rapid_to(r_);
  }
  end_ = {hole_.first, hole_.second, clear_};
  drill();
}

// Stores the words of the block. Missing words keep their previous values.
void Cycle::recall() {
  if (!words_.r && !repeated_)
    throw ProgramFault{"", "the cycle requires R, the level from which it feeds"};
  if (!words_.depth && !repeated_)
    throw ProgramFault{"",
                       "the cycle requires the bottom of the hole (Z in G17, Y in G18, X in G19)"};
  const bool dwells = code_ == 820 || code_ == 860 || code_ == 880 || code_ == 890;
  if (dwells && !words_.p && !repeated_ && !memory_->lenient)
    throw ProgramFault{"", "the cycle requires P, the dwell at the bottom in seconds"};
  if (words_.p) memory_->p = *words_.p;
  const bool pecks = code_ == 730 || code_ == 830;
  if (words_.q) memory_->q = *words_.q;
  if (memory_->lenient && pecks && memory_->q <= 0) memory_->q = kOnePeck;
  if (pecks && !words_.q && !repeated_ && !memory_->lenient)
    throw ProgramFault{"", "the cycle requires Q, the depth of a peck"};

  if (pecks && !(memory_->q > 0)) throw ProgramFault{"", "Q, the depth of a peck, must be above 0"};
  if (code_ == 870 && !repeated_ && !memory_->lenient && (!words_.i || !words_.j || !words_.k))
    throw ProgramFault{"", "G87 requires I, J and K"};
  if (words_.i) memory_->i = *words_.i;
  if (words_.j) memory_->j = *words_.j;
  if (words_.k) memory_->k = *words_.k;
  const bool turns = code_ == 740 || code_ == 840 || (code_ >= 860 && code_ <= 880);
  if (memory_->lenient) return;
  if (turns && modes_.spindle == GcodeSpindle::kStopped)
    throw ProgramFault{"", "the cycle requires a turning spindle; start it with M3 or M4"};
  if ((code_ == 840 && modes_.spindle == GcodeSpindle::kCounterClockwise) ||
      (code_ == 740 && modes_.spindle == GcodeSpindle::kClockwise))
    throw ProgramFault{"",
                       "the spindle turns in the wrong direction; use M3 for G84 and M4 for G74"};
}

// Stores R and the depth as written, or as levels.
void Cycle::recall_heights(double initial) {
  const bool adds = memory_->levels && modes_.incremental;
  if (words_.r) memory_->r = adds ? initial + *words_.r : *words_.r;
  if (words_.depth) memory_->depth = adds ? memory_->r + *words_.depth : *words_.depth;
}

void Cycle::set_heights(double initial) {
  const bool adds = !memory_->levels && modes_.incremental;
  r_ = adds ? memory_->r + initial : memory_->r;
  bottom_ = adds ? r_ + memory_->depth : memory_->depth;
  if (r_ < bottom_)
    throw ProgramFault{"", "the R level of the cycle must not be below the bottom of the hole"};
  middle_ = modes_.incremental ? bottom_ + memory_->k : memory_->k;
}

void Cycle::set_hole() {
  if (words_.distance || words_.angle_deg) {
    const double radius =
        words_.distance ? *words_.distance : std::hypot(hole_.first, hole_.second);
    const double angle =
        words_.angle_deg ? *words_.angle_deg * kRadPerDeg : std::atan2(hole_.second, hole_.first);
    hole_.first = radius * std::cos(angle);
    hole_.second = radius * std::sin(angle);
    return;
  }
  if (words_.first) hole_.first = *words_.first;
  if (words_.second) hole_.second = *words_.second;
}

void Cycle::advance_hole() {
  hole_.first += words_.first.value_or(0);
  hole_.second += words_.second.value_or(0);
  const double more_radius = words_.distance.value_or(0);
  const double more_angle = words_.angle_deg.value_or(0) * kRadPerDeg;
  if (more_radius == 0 && more_angle == 0) return;
  if (hole_.first == 0 && hole_.second == 0)
    throw ProgramFault{"", "polar increments require a position other than the origin"};
  const double radius = std::hypot(hole_.first, hole_.second) + more_radius;
  const double angle = std::atan2(hole_.second, hole_.first) + more_angle;
  hole_.first = radius * std::cos(angle);
  hole_.second = radius * std::sin(angle);
}

void Cycle::drill() {
  switch (code_) {
    case 730:
    case 830:
      peck_ = r_ - memory_->q;
      return;
    case 850:
      feed_to(bottom_);
      feed_to(r_);
      return rapid_to(clear_);
    case 740:
    case 840:
    case 890:
      feed_to(bottom_);
      dwell();
      return feed_to(clear_);
    case 870:
      return bore_back();
    case 760:
    case 820:
    case 860:
      feed_to(bottom_);
      dwell();
      return rapid_to(clear_);
    case 880:  // the operator retracts manually; the program continues from the bottom
      feed_to(bottom_);
      return dwell();
    default:
      feed_to(bottom_);
      return rapid_to(clear_);
  }
}

// One peck, or the rest of the hole.
void Cycle::peck() {
  const double depth = *peck_;
  if (!(depth > bottom_)) {
    peck_.reset();
    feed_to(bottom_);
    return rapid_to(clear_);
  }
  feed_to(depth);
  if (code_ == 830) rapid_to(r_);
  rapid_to(depth + kPeckClearanceMm / modes_.unit_mm);
  *peck_ -= memory_->q;
}

// G87, back boring: passes the hole off its axis, then bores from below.
void Cycle::bore_back() {
  const PlanePoint beside{hole_.first + memory_->i, hole_.second + memory_->j, 0};
  rapid({beside.first, beside.second, r_});
  rapid({beside.first, beside.second, bottom_});
  rapid_to(bottom_);
  feed_to(middle_);
  feed_to(bottom_);
  rapid({beside.first, beside.second, bottom_});
  rapid({beside.first, beside.second, clear_});
  rapid_to(clear_);
}

void Cycle::feed_to(double normal) {
  steps_.push_back(
      {.kind = CycleStep::Kind::kFeed, .to = in_mm({hole_.first, hole_.second, normal})});
}

void Cycle::dwell() { steps_.push_back({.kind = CycleStep::Kind::kDwell, .seconds = memory_->p}); }

}  // namespace kerf
