// SPDX-License-Identifier: Apache-2.0
#include "server/formats/drilling_cycles.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "server/formats/gcode/cycle.h"
#include "server/formats/pose_grid.h"

namespace kerf {
namespace {

using Motions = std::span<const ProgramMotion>;

/// Most motions of one hole. Longer ones are written as motions.
constexpr std::size_t kMotionsMax = 4096;
/// Greatest relative difference of the feeds of one hole, below 7 digits of F.
constexpr double kFeedTolerance = 5e-7;

bool upright(const ToolPose& pose) { return pose.axis == Vec3{0, 0, 1}; }
bool rests(const ProgramMotion& motion) { return motion.from == motion.to; }
bool vertical(const ProgramMotion& motion) {
  return motion.from.tip_mm.x == motion.to.tip_mm.x && motion.from.tip_mm.y == motion.to.tip_mm.y;
}
bool traverses(const ProgramMotion& motion) {
  return motion.rapid && !vertical(motion) && motion.from.tip_mm.z == motion.to.tip_mm.z;
}
bool feeds(const ProgramMotion& motion) { return !motion.rapid && !rests(motion); }
double top(const ProgramMotion& motion) { return motion.from.tip_mm.z; }
double bottom(const ProgramMotion& motion) { return motion.to.tip_mm.z; }
double feed_of(const ProgramMotion& motion) {
  return 60 * std::abs(bottom(motion) - top(motion)) / motion.duration_s;
}

/// A hole and its motions within the given ones.
struct FoundHole {
  DrilledHole hole;
  Motions motions;
};

/// Returns the first motion of a hole: the traverse to it and the descent precede the first feed.
std::size_t begin_of_hole(Motions parts, std::size_t first_feed) {
  std::size_t begin = first_feed;
  if (begin > 0 && vertical(parts[begin - 1])) --begin;
  if (begin > 0 && traverses(parts[begin - 1])) --begin;
  return begin;
}

DrilledHole hole_of(Motions motions, std::size_t first_feed, std::size_t last_feed) {
  const ProgramMotion& first = motions[first_feed];
  DrilledHole hole{.x_mm = first.to.tip_mm.x,
                   .y_mm = first.to.tip_mm.y,
                   .r_mm = top(first),
                   .bottom_mm = bottom(motions[last_feed]),
                   .clear_mm = bottom(motions.back()),
                   .mm_per_min = feed_of(first)};
  if (first_feed != last_feed) {
    const bool clears_chips = bottom(motions[first_feed + 1]) == hole.r_mm;
    hole.code = clears_chips ? 83 : 73;
    hole.peck_mm = std::round((hole.r_mm - bottom(first)) / kTipGridMm) * kTipGridMm;
  } else if (rests(motions[last_feed + 1])) {
    hole.code = 82;
    hole.dwell_s = motions[last_feed + 1].duration_s;
  }
  return hole;
}

Cycle cycle_of(const DrilledHole& hole, Vec3 from, CycleMemory& memory) {
  GcodeModes modes;
  modes.retract_to_r = hole.clear_mm == hole.r_mm;
  CycleWords words;
  words.first = hole.x_mm;
  words.second = hole.y_mm;
  words.depth = hole.bottom_mm;
  words.r = hole.r_mm;
  words.p = hole.dwell_s;
  if (hole.peck_mm > 0) words.q = hole.peck_mm;
  return {hole.code * 10, modes, in_plane(from, ArcPlane::kXy), words, memory};
}

/// Whether the motion is that step of the cycle.
bool makes(const CycleStep& step, const ToolPose& to, const ProgramMotion& motion,
           double mm_per_min) {
  if (step.kind == CycleStep::Kind::kDwell)
    return rests(motion) && motion.duration_s == step.seconds;
  if (rests(motion) || !(motion.to == to)) return false;
  if (step.kind == CycleStep::Kind::kRapid) return motion.rapid;
  return !motion.rapid && std::abs(feed_of(motion) / mm_per_min - 1) <= kFeedTolerance;
}

bool makes(const DrilledHole& hole, Motions motions) {
  CycleMemory memory{.lenient = true, .initial_level = {}};
  ToolPose at = motions.front().from;
  Cycle cycle = cycle_of(hole, at.tip_mm, memory);
  while (const auto step = cycle.next()) {
    ToolPose to = at;
    if (step->kind != CycleStep::Kind::kDwell) {
      to = admit_pose({from_plane(step->to, ArcPlane::kXy), at.axis});
      if (to == at) continue;
    }
    if (motions.empty() || !makes(*step, to, motions.front(), hole.mm_per_min)) return false;
    motions = motions.subspan(1);
    at = to;
  }
  return motions.empty();
}

/// Finds a hole in motions that, except the first, are along one vertical line.
std::optional<FoundHole> find_hole(Motions parts) {
  const auto first = std::ranges::find_if(parts, feeds);
  if (first == parts.end() || !vertical(*first) || bottom(*first) >= top(*first)) return {};
  const auto first_feed = static_cast<std::size_t>(first - parts.begin());
  std::size_t last_feed = parts.size() - 1;
  while (!feeds(parts[last_feed])) --last_feed;
  std::size_t end = last_feed + 1;
  if (first_feed == last_feed && end < parts.size() && rests(parts[end])) ++end;
  if (end >= parts.size() || !parts[end].rapid) return {};
  const std::size_t begin = begin_of_hole(parts, first_feed);
  const Motions motions = parts.subspan(begin, end + 1 - begin);
  const DrilledHole hole = hole_of(motions, first_feed - begin, last_feed - begin);
  if (!makes(hole, motions)) return {};
  return FoundHole{hole, motions};
}

}  // namespace

DrillingCycles::DrillingCycles(std::unique_ptr<ProgramWriter> writer)
    : writer_(std::move(writer)) {}

void DrillingCycles::note(const std::string& line) { writer_->note(line); }

WriteResult DrillingCycles::add(const ProgramMotion& motion) {
  const bool follows = !parts_.empty() && parts_.back().tool == motion.tool &&
                       parts_.back().to == motion.from && vertical(motion) && upright(motion.to) &&
                       parts_.size() < kMotionsMax;
  if (!follows)
    if (auto done = flush(); !done) return done;
  const bool begins = upright(motion.from) && upright(motion.to) && !rests(motion) &&
                      (vertical(motion) || traverses(motion));
  if (!follows && !begins) return writer_->add(motion);
  parts_.push_back(motion);
  return {};
}

// Forwards the parts, with a hole among them as a cycle.
WriteResult DrillingCycles::flush() {
  const std::vector<ProgramMotion> parts = std::exchange(parts_, {});
  const auto found = find_hole(parts);
  const bool written_as_cycle = found && writer_->drills(found->hole);
  for (auto motion = parts.begin(); motion != parts.end();) {
    WriteResult written;
    if (written_as_cycle && &*motion == found->motions.data()) {
      written = writer_->add_hole(*motion, found->hole);
      motion += static_cast<std::ptrdiff_t>(found->motions.size());
    } else {
      written = writer_->add(*motion++);
    }
    if (!written) return written;
  }
  return {};
}

WriteResult DrillingCycles::remark(const MachineRemark& said) {
  if (auto done = flush(); !done) return done;
  return writer_->remark(said);
}

WriteResult DrillingCycles::finish() {
  if (auto done = flush(); !done) return done;
  return writer_->finish();
}

}  // namespace kerf
