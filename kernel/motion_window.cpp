// SPDX-License-Identifier: Apache-2.0
#include "kernel/motion_window.h"

#include <algorithm>
#include <utility>

#include "kernel/cut/imprint.h"
#include "kernel/cut/lazy_normals.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/force/collision.h"
#include "kernel/force/cutting_force.h"
#include "kernel/force/stock_contact.h"
#include "kernel/motion_reach.h"

namespace kerf {
namespace {

/// Greatest number of sweeps that are cut together. Their memory is about 1 MB.
constexpr std::size_t kSweepsMax = 256;

bool overlap(const Bounds& a, const Bounds& b) {
  return a.lo_mm.x <= b.hi_mm.x && b.lo_mm.x <= a.hi_mm.x && a.lo_mm.y <= b.hi_mm.y &&
         b.lo_mm.y <= a.hi_mm.y && a.lo_mm.z <= b.hi_mm.z && b.lo_mm.z <= a.hi_mm.z;
}

}  // namespace

/// A motion, from its plan until its force is known.
struct MotionWindow::Motion {
  /// The removal from one field.
  struct Removed {
    std::int64_t quanta = 0, imprint = 0, elements = 0;
    double border = 0, border_imprint = 0;  ///< additional quanta, by the shares of the columns
  };
  const MoveTool* move;
  const Tool* tool;
  ToolMotion motion;
  MotionStart start;
  bool feel;
  std::shared_ptr<Engagement> engagement;
  MotionResult* result;
  std::vector<Removed> removed;                       ///< from each field
  std::vector<std::vector<SubMotion>> standing = {};  ///< at its start, in each field, for imprints
  std::optional<SurfaceWeight> weight = {};
  std::optional<CuttingForce> force = {};
};

/// One sub-motion in one field.
struct MotionWindow::Cut {
  Motion* motion;
  std::size_t field;
  SubMotion part;
  bool is_first;         ///< of the motion in this field
  bool has_begun;        ///< in the previous window
  bool goes_on = false;  ///< it continues in the next window
  std::optional<CutSummer> summer;
};

/// The removal of a sub-motion from a tile.
struct MotionWindow::Outcome {
  std::int64_t quanta = 0, imprint = 0, elements = 0;
  double border = 0, border_imprint = 0;
  RemovedDepths depths;
  std::vector<RemovedGroup> groups;  ///< without the imprint; for the mechanistic law only
};

MotionWindow::MotionWindow() = default;
MotionWindow::~MotionWindow() = default;

std::vector<MotionResult> MotionWindow::apply(Sculpture& block, std::span<const MoveTool> moves,
                                              Workers& workers,
                                              const Sculpture::AfterMotion& after) {
  block_ = &block;
  workers_ = &workers;
  after_ = &after;
  finished_ = 0;
  drop();  // left by a call that ended with an exception
  std::vector<MotionResult> results(moves.size());
  for (std::size_t n = 0; n < moves.size(); ++n) plan(moves[n], results[n]);
  flush();
  return results;
}

/// Returns whether a motion may cut where an earlier one will still read the stock.
bool MotionWindow::waits(const Tool& tool, const ToolMotion& motion) const {
  if (reads_.empty()) return false;
  double margin_mm = block_->settings_.tolerance_mm;
  for (const DexelField& field : block_->fields_) {
    margin_mm = std::max(margin_mm, block_->settings_.tolerance_mm + field.grid().z_quantum_mm);
  }
  const Bounds box = grown(reach_of(tool, motion), margin_mm);
  return std::ranges::any_of(reads_, [&](const Bounds& read) { return overlap(read, box); });
}

void MotionWindow::plan(const MoveTool& move, MotionResult& result) {
  Sculpture& b = *block_;
  const Tool& tool = b.tools_.at(move.tool);
  const ToolMotion whole = motion_of(move, tool);
  if (waits(tool, whole)) flush();
  const bool feel = move.feel && move.duration_s > 0;
  // The end as commanded. In `whole`, an axis that turns by less than rounding is not turned.
  const ToolPose end{move.to.tip_mm, normalized(move.to.axis)};
  auto [engagement, continues] = b.engagements_->follow(move.tool, whole.from, end, feel);
  const auto last = b.last_pose_.find(move.tool);
  const bool is_cut = last != b.last_pose_.end() && last->second == whole.from;
  b.last_pose_[move.tool] = whole.to;
  Motion& motion =
      motions_.emplace_back(Motion{.move = &move,
                                   .tool = &tool,
                                   .motion = whole,
                                   .start = {is_cut, continues},
                                   .feel = feel,
                                   .engagement = std::move(engagement),
                                   .result = &result,
                                   .removed = std::vector<Motion::Removed>(b.fields_.size())});
  result.kind = whole.kind;
  if (feel && b.fields_.size() > 1) motion.weight.emplace(tool);
  for (std::size_t n = 0; n < b.fields_.size(); ++n) plan_field(motion, n);
  if (tool.non_cutting.empty()) return;
  const Bounds read = non_cutting_reach(tool, whole);
  if (std::ranges::any_of(b.fields_, [&](const DexelField& f) {
        const SweepBounds rays = ray_bounds(f.grid());
        return overlap(read, grown({from_frame(f.grid().axis, rays.min_mm),
                                    from_frame(f.grid().axis, rays.max_mm)},
                                   f.grid().pitch_mm));
      })) {
    reads_.push_back(read);
  }
}

void MotionWindow::plan_field(Motion& motion, std::size_t n) {
  DexelField& field = block_->fields_[n];
  const DexelGrid& grid = field.grid();
  SweepSettings settings = block_->sweep_settings(field);
  if (!motion.start.continues) {
    const ToolPose& from = motion.motion.from;
    std::vector<SubMotion>& standing = motion.standing.emplace_back();
    sweep_tool(*motion.tool, in_frame(grid.axis, make_motion(from, from, motion.tool->length_mm)),
               settings, [&](SubMotion&& rest) { standing.push_back(std::move(rest)); });
  }
  settings.start_is_cut = motion.start.is_cut;
  std::int64_t parts = 0;
  sweep_tool(*motion.tool, in_frame(grid.axis, motion.motion), settings, [&](SubMotion&& part) {
    const bool is_first = parts == 0;
    parts += part.count;
    plan_part(motion, n, std::move(part), is_first);
  });
  motion.result->sub_motions =
      std::max(motion.result->sub_motions, static_cast<std::uint32_t>(parts));
}

/// Plans a sub-motion. One that reaches more tiles than a window holds is cut in several windows.
void MotionWindow::plan_part(Motion& motion, std::size_t n, SubMotion&& part, bool is_first) {
  DexelField& field = block_->fields_[n];
  LazyNormals& normals = block_->normals_[n];
  if (cuts_used_ == kSweepsMax || window_.is_full() || normals.is_full()) cut_all();
  if (normals.is_full()) normals.begin_batch(field, *workers_);
  const NormalCode end_code = normals.add_sweep(field, *motion.tool, part.motion);
  for (std::int64_t first = 0;;) {
    if (cuts_used_ == cuts_.size()) cuts_.push_back(std::make_unique<Cut>());
    Cut& cut = *cuts_[cuts_used_++];
    cut = {&motion, n, std::move(part), is_first, first > 0, false, {}};
    if (motion.feel) {
      cut.summer = make_summer(block_->settings_.force, *motion.tool, field, cut.part.motion,
                               motion.weight ? &*motion.weight : nullptr);
    }
    first = window_.add(field, cut.part.swept, end_code, first);
    if (first == 0) return;
    cut.goes_on = true;
    cut_all();
    part = std::move(cut.part);
  }
}

/// Finishes all motions that have been planned.
void MotionWindow::flush() {
  cut_all();
  finish_motions(nullptr);
  reads_.clear();
}

void MotionWindow::drop() {
  window_.clear();
  cuts_used_ = 0;
  motions_.clear();
  reads_.clear();
  felt_ = {};
}

/// Cuts everything that has been planned, and adds it to the forces of the motions.
void MotionWindow::cut_all() {
  const std::span<const CutWindow::Touch> touches = window_.touches();
  if (outcomes_.size() < touches.size()) outcomes_.resize(touches.size());
  for (std::size_t n = 0; n < touches.size(); ++n) outcomes_[n].quanta = 0;
  const bool feel = std::ranges::any_of(motions_, &Motion::feel);
  if (feel && sums_.size() < touches.size()) sums_.resize(touches.size());
  window_.cut(*workers_,
              [this](std::size_t touch, RemovedPart& removed) { measure(touch, removed); });
  std::size_t first = 0;
  for (std::size_t n = 0; n < cuts_used_; ++n) {
    std::size_t end = first;
    while (end < touches.size() && touches[end].sweep == n) ++end;
    finish_motions(cuts_[n]->motion);
    deliver(*cuts_[n], first, end);
    first = end;
  }
  window_.clear();
  cuts_used_ = 0;
  for (std::size_t n = 0; n < block_->fields_.size(); ++n) {
    block_->normals_[n].resolve_some(block_->fields_[n], *workers_);
  }
}

/// Called on any thread.
void MotionWindow::measure(std::size_t touch, RemovedPart& removed) {
  const Cut& cut = *cuts_[window_.touches()[touch].sweep];
  const Motion& motion = *cut.motion;
  const DexelField& field = block_->fields_[cut.field];
  const DexelGrid& grid = field.grid();
  Outcome& outcome = outcomes_[touch];
  outcome.quanta = removed.quanta;
  outcome.imprint = outcome.elements = 0;
  outcome.border = border_quanta(removed.groups, field.shares());
  outcome.border_imprint = 0;
  if (block_->fields_.size() > 1) outcome.elements = elements_of(removed.groups);
  if (grid.axis != RayAxis::kZ) outcome.depths = depths_of(removed.groups);
  // Every later part starts where the previous part ended.
  if (cut.is_first && !motion.start.continues) {
    for (const SubMotion& standing : motion.standing[cut.field]) {
      outcome.imprint += take_imprint(standing.swept, grid, removed);
    }
    if (outcome.imprint > 0)
      outcome.border_imprint = outcome.border - border_quanta(removed.groups, field.shares());
  }
  if (!motion.feel) return;
  sums_[touch] = cut.summer->sum(removed.groups);
  if (block_->settings_.force.law == ForceLaw::kMechanistic) outcome.groups = removed.groups;
}

/// Adds up the removal of a sub-motion from the tiles `first` to `end` of its touches.
void MotionWindow::deliver(Cut& cut, std::size_t first, std::size_t end) {
  Sculpture& b = *block_;
  Motion& motion = *cut.motion;
  const DexelGrid& grid = b.fields_[cut.field].grid();
  Motion::Removed& all = motion.removed[cut.field];
  RemovedPart& felt = (cut.has_begun ? b.removal_->parts() : b.removal_->start(1)).front();
  auto [sums, felt_quanta] = std::exchange(felt_, {});
  for (std::size_t n = first; n < end; ++n) {
    const Outcome& outcome = outcomes_[n];
    if (outcome.quanta == 0) continue;
    const TileIndex tile = window_.touches()[n].tile;
    b.normals_[cut.field].add_tile(tile);
    append_changed_tiles(grid, tile, outcome.depths, motion.result->changed_tiles);
    motion.result->cut_tiles.push_back({grid.axis, tile});
    all.quanta += outcome.quanta;
    all.imprint += outcome.imprint;
    all.border += outcome.border;
    all.border_imprint += outcome.border_imprint;
    all.elements += outcome.elements;
    if (!motion.feel) continue;
    felt_quanta += outcome.quanta - outcome.imprint;
    sums.add(sums_[n]);
    if (b.settings_.force.law != ForceLaw::kMechanistic) continue;
    felt.groups.insert(felt.groups.end(), outcome.groups.begin(), outcome.groups.end());
    felt.tiles.push_back({tile, felt.groups.size()});
    felt.quanta = felt_quanta;
  }
  if (!motion.feel) return;
  if (cut.goes_on) {
    felt_ = {sums, felt_quanta};
    return;
  }
  CuttingForce& force = force_of(motion);
  if (felt_quanta > 0)
    force.add(b.fields_[cut.field], *cut.summer, sums, *b.removal_, cut.part.share);
}

/// The forces of a tool's user are added up in the order of its motions, because each begins with
/// the force that the one before it has left pending.
CuttingForce& MotionWindow::force_of(Motion& motion) {
  if (!motion.force) {
    motion.force.emplace(block_->settings_.force, *motion.tool, motion.motion,
                         motion.move->duration_s, static_cast<int>(block_->fields_.size()),
                         *motion.engagement);
  }
  return *motion.force;
}

/// Finishes the motions before `until`, one that has begun to be delivered, or all if it is null.
void MotionWindow::finish_motions(const Motion* until) {
  while (!motions_.empty() && &motions_.front() != until) {
    finish(motions_.front());
    if (*after_) (*after_)(finished_, *motions_.front().result);
    ++finished_;
    motions_.pop_front();
  }
}

void MotionWindow::finish(Motion& motion) {
  Sculpture& b = *block_;
  const Tool& tool = *motion.tool;
  MotionResult& result = *motion.result;
  std::vector<RemovedVolume> removed;
  for (std::size_t n = 0; n < motion.removed.size(); ++n) {
    const Motion::Removed& r = motion.removed[n];
    const double quantum_mm3 = b.fields_[n].grid().quantum_mm3();
    removed.push_back({(static_cast<double>(r.quanta) + r.border) * quantum_mm3,
                       (static_cast<double>(r.imprint) + r.border_imprint) * quantum_mm3,
                       static_cast<double>(r.elements)});
  }
  b.count_motion(removed, result);
  if (!tool.non_cutting.empty()) {
    result.stock_contact_mm =
        deepest_stock_contact(tool, motion.motion, b.fields_, b.settings_.tolerance_mm);
  }
  if (!motion.feel) return;
  const FeltCut felt = force_of(motion).finish();
  result.wrench = felt.wrench;
  if (felt.area_mm2 > 0) {
    result.cutting = {felt.area_mm2, normalized(felt.wrench.force_n), felt.center_mm};
  }
  result.collision = b.collision(tool, motion.motion.to);
  result.wrench = result.wrench + result.collision;
}

}  // namespace kerf
