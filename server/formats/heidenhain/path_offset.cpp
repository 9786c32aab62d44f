// SPDX-License-Identifier: Apache-2.0
// Radius compensation of KlartextPath: RL, RR and R0.
#include <cmath>

#include "server/formats/heidenhain/blocks.h"
#include "server/formats/heidenhain/path.h"

namespace kerf {
namespace {

constexpr double kLevelMm = 1e-9;

Vec3 at_level(PlanePoint point, double z) { return {point.first, point.second, z}; }

}  // namespace

Vec3 KlartextPath::position() const {
  if (approach_) return approach_->contour;
  if (!compensation_.on()) return frame_.programmed(tip_mm_);
  return compensation_.beside() ? at_level(compensation_.programmed(), center_.z) : center_;
}

Vec3 KlartextPath::contour() const {
  const Vec3 at = position();
  return beside_ ? at_level(*beside_, at.z) : at;
}

void KlartextPath::compensate(int side, double offset_mm) {
  if (side == this->side()) return;
  if (approach_) finish_approach();
  const PlanePoint at = in_plane(center_, ArcPlane::kXy);
  if (compensation_.on()) {
    if (side != 0) throw ProgramFault{"RL", "and RR may follow each other only behind R0"};
    beside_ = compensation_.end(at);
    return;
  }
  if (side == 0) return;
  center_ = frame_.programmed(tip_mm_);
  offset_mm_ = offset_mm;
  compensation_.start(side, offset_mm, ArcPlane::kXy);
}

CompensatedInfo KlartextPath::info_of(std::optional<double> feed, std::array<bool, 3> named) const {
  CompensatedInfo info;
  info.line = line_;
  info.feed.mm_per_min = feed.value_or(0);
  for (std::size_t i = 0; i < named.size(); ++i) info.named[i] = named[i];
  return info;
}

void KlartextPath::line(Vec3 to, const RotaryAngles& angles, std::optional<double> feed,
                        std::array<bool, 3> named) {
  const bool starts = compensation_.active() && !compensation_.beside();
  if (starts && angles == angles_) return approach_by_line(to, feed);
  if (approach_ && to.x == approach_->contour.x && to.y == approach_->contour.y) {
    if (!(angles == angles_)) throw ProgramFault{"RL", "with turning tables is not supported"};
    if (lifts_.empty()) approach_->level = approach_->contour.z;
    lifts_.push_back({to.z, feed});
    approach_->contour.z = to.z;
    return;
  }
  if (approach_) begin_contour(to - approach_->contour);
  if (named[0] || named[1]) beside_.reset();
  if (!compensation_.active()) {
    move_line(to, angles, feed, named);
    center_ = to;
    return;
  }
  if (!(angles == angles_)) throw ProgramFault{"RL", "with turning tables is not supported"};
  const PlanePoint end = compensation_.straight(!feed, in_plane(center_, ArcPlane::kXy),
                                                in_plane(to, ArcPlane::kXy), info_of(feed, named));
  center_ = from_plane(end, ArcPlane::kXy);
}

void KlartextPath::arc(Vec3 to, ArcPlane plane, Vec3 center, int turns, double feed) {
  if (approach_ && plane == ArcPlane::kXy) {
    const Vec3 out = approach_->contour - center;
    begin_contour(turns > 0 ? Vec3{-out.y, out.x, 0} : Vec3{out.y, -out.x, 0});
  }
  if (approach_) throw ProgramFault{"RL", "is supported for arcs in XY only"};
  beside_.reset();
  if (!compensation_.active()) {
    move_arc(to, plane, center, turns, feed);
    center_ = to;
    return;
  }
  if (plane != ArcPlane::kXy) throw ProgramFault{"RL", "is supported for arcs in XY only"};
  const ArcCenter about{.ijk = center, .absolute = true};
  const PlanePoint end = compensation_.arc(
      in_plane(center_, plane), in_plane(to, plane), about, turns < 0, turns < 0 ? -turns : turns,
      kSpiralToleranceMm, info_of(feed, {true, true, std::abs(to.z - center_.z) > kLevelMm}));
  center_ = from_plane(end, plane);
}

void KlartextPath::emit(const CompensatedMove& move) {
  const std::size_t line = line_;
  line_ = move.info.line;
  const Vec3 end = from_plane(move.end, ArcPlane::kXy);
  const double feed = move.info.feed.mm_per_min;
  const std::array named{move.info.named[0], move.info.named[1], move.info.named[2]};
  if (move.kind == CompensatedMove::Kind::kDwell) {
    check(sink_.dwell(move.seconds, line_));
  } else if (move.kind == CompensatedMove::Kind::kArc) {
    move_arc(end, ArcPlane::kXy, from_plane(move.center, ArcPlane::kXy), move.turns, feed);
  } else {
    const bool rapid = move.kind == CompensatedMove::Kind::kRapid;
    move_line(end, angles_, rapid ? std::nullopt : std::optional(feed), named);
  }
  line_ = line;
}

// The next element determines the offset end of the line.
void KlartextPath::approach_by_line(Vec3 to, std::optional<double> feed) {
  KlartextApproach approach{.kind = KlartextApproach::Kind::kDirect,
                            .contour = to,
                            .side = compensation_.side(),
                            .offset_mm = offset_mm_,
                            .feed = feed.value_or(0),
                            .is_rapid = !feed};
  compensation_.end(in_plane(center_, ArcPlane::kXy));
  beside_.reset();
  approach_ = approach;
}

// Without a contour a line ends across its own direction.
void KlartextPath::finish_approach() {
  if (approach_->kind != KlartextApproach::Kind::kDirect)
    throw ProgramFault{"APPR", "must be followed by a contour in the plane XY"};
  begin_contour(approach_->contour - frame_.programmed(tip_mm_));
}

void KlartextPath::finish() {
  if (approach_) finish_approach();
  compensation_.flush(in_plane(center_, ArcPlane::kXy));
}

}  // namespace kerf
