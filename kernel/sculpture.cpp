// SPDX-License-Identifier: Apache-2.0
#include "kernel/sculpture.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "kernel/cut/imprint.h"
#include "kernel/cut/lazy_normals.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/estimated_normals.h"
#include "kernel/dexel/mesh_stock.h"
#include "kernel/dexel/stock_column.h"
#include "kernel/force/collision.h"
#include "kernel/force/engagement.h"
#include "kernel/force/stock_contact.h"
#include "kernel/motion_window.h"
#include "kernel/sculpture_check.h"
#include "kernel/sculpture_motion.h"
#include "kernel/sweep/swept_tool.h"
#include "kernel/sweep/tool_motion.h"

namespace kerf {

namespace {

/// Combines the volumes that the fields measured. With three fields, each is weighted by the square
/// of the area that it sees. For a thin layer with normal n this area is |n_a| times the layer's,
/// so the weights are n_a². Fields whose rays graze the surface, and locate it only to a pitch,
/// have little weight.
double combined_mm3(std::span<const RemovedVolume> fields, double RemovedVolume::* volume) {
  if (fields.size() == 1) return fields.front().*volume;
  double sum = 0, weights = 0;
  for (const RemovedVolume& f : fields) {
    sum += f.elements * f.elements * f.*volume;
    weights += f.elements * f.elements;
  }
  return weights > 0 ? sum / weights : 0;
}

}  // namespace

Sculpture::Sculpture(SculptureSettings settings, const StopAsked& stop_asked)
    : settings_(std::move(settings)),
      obstacles_(settings_.obstacles.empty() ? nullptr
                                             : std::make_unique<Obstacles>(settings_.obstacles)),
      engagements_(std::make_unique<Engagements>(settings_.pitch_mm)),
      removal_(std::make_unique<Removal>()),
      window_(std::make_unique<MotionWindow>()) {
  for (const RayAxis axis : axes_of(settings_.rays)) {
    if (settings_.stock_mesh) {
      fields_.emplace_back(*settings_.stock_mesh, settings_.pitch_mm, axis, settings_.keep_normals,
                           stop_asked);
    } else {
      fields_.emplace_back(settings_.stock, settings_.pitch_mm, axis, settings_.keep_normals);
    }
    stock_volume_mm3_ += fields_.back().stock_volume_mm3();
  }
  normals_.resize(fields_.size());
  stock_volume_mm3_ /= double(fields_.size());
  settings_.stock_mesh.reset();
}

Sculpture::Sculpture(Sculpture&&) noexcept = default;
Sculpture& Sculpture::operator=(Sculpture&&) noexcept = default;
Sculpture::~Sculpture() = default;

std::expected<Sculpture, SculptureError> Sculpture::create(SculptureSettings settings,
                                                           const StopAsked& stop_asked) {
  if (settings.stock_mesh) {
    const std::string fault = mesh_stock_fault(*settings.stock_mesh);
    if (!fault.empty())
      return std::unexpected(SculptureError{SculptureErrorCode::kBadStock, fault});
    settings.stock = mesh_bounds(*settings.stock_mesh);
  }
  if (auto c = check_settings(settings); !c) return std::unexpected(c.error());
  Sculpture made(std::move(settings), stop_asked);
  if (stop_asked && stop_asked())
    return std::unexpected(SculptureError{SculptureErrorCode::kStopped, "a stop was asked"});
  return made;
}

const DexelGrid& Sculpture::grid() const { return fields_.front().grid(); }

const DexelField* Sculpture::field(RayAxis axis) const {
  const auto found = std::ranges::find(fields_, axis, [](auto& f) { return f.grid().axis; });
  return found == fields_.end() ? nullptr : &*found;
}

void Sculpture::keep_common(FieldTile at, const TileColumns& other) {
  const auto found = std::ranges::find(fields_, at.axis, [](auto& f) { return f.grid().axis; });
  if (found == fields_.end() || !found->grid().has(at.tile)) return;
  const auto keep = [&](DexelTile& tile) {
    const bool changed = kerf::keep_common(tile, other);
    if (changed && tile.keeps_normals())
      estimate_normals(tile, at.tile, found->stock(), found->grid());
    return changed;
  };
  if (DexelTile* tile = found->editable(at.tile)) {
    keep(*tile);
    return;
  }
  const std::shared_ptr<DexelTile> fresh = found->fresh(at.tile);
  if (keep(*fresh)) found->put(at.tile, fresh);
}

const Tool* Sculpture::tool(ToolId id) const {
  const auto it = tools_.find(id);
  return it == tools_.end() ? nullptr : &it->second;
}

std::size_t Sculpture::place_of(RayAxis axis) const {
  std::size_t n = 0;
  while (fields_[n].grid().axis != axis) ++n;
  return n;
}

DexelSnapshot Sculpture::snapshot(RayAxis axis) {
  const std::size_t n = place_of(axis);
  normals_[n].resolve(fields_[n]);
  return fields_[n].snapshot();
}

std::size_t Sculpture::memory_bytes() const {
  std::size_t bytes = 0;
  for (const DexelField& f : fields_) bytes += f.memory_bytes();
  return bytes;
}

std::size_t Sculpture::working_bytes() const {
  std::size_t bytes = 0;
  for (const LazyNormals& normals : normals_) bytes += normals.bytes();
  return bytes;
}

SolidSnapshot Sculpture::solid() {
  SolidSnapshot all;
  for (const DexelField& f : fields_) all.fields.push_back(snapshot(f.grid().axis));
  return all;
}

std::expected<void, SculptureError> Sculpture::check(const Command& command) const {
  if (const auto* move = std::get_if<MoveTool>(&command)) return check_move(*move);
  const auto& define = std::get<DefineTool>(command);
  if (auto tool = make_tool(define.tool.pieces, define.tool.non_cutting); !tool) {
    return reject(SculptureErrorCode::kBadTool, tool.error().field + " " + tool.error().reason);
  }
  return {};
}

std::expected<void, SculptureError> Sculpture::check_move(const MoveTool& command) const {
  using enum SculptureErrorCode;
  const Tool* used = tool(command.tool);
  if (used == nullptr) {
    return reject(kUnknownTool, "tool " + std::to_string(command.tool) + " is not defined");
  }
  if (auto c = check_pose("start", command.from); !c) return c;
  if (auto c = check_pose("end", command.to); !c) return c;
  const int duration = std::fpclassify(command.duration_s);
  if (!(duration == FP_ZERO || duration == FP_NORMAL) || command.duration_s < 0) {
    return reject(kBadDuration, "duration_s must be finite, >= 0 and not denormal");
  }
  const ToolMotion motion = motion_of(command, *used);
  if (motion.turn_rad > kTurnMaxRad) {
    return reject(kTurnTooLarge, "a motion may turn the axis by at most 170 degrees");
  }
  if (motion.turn_rad == 0) return {};  // any tool needs one sub-motion
  std::int64_t parts = 0;
  for (const DexelField& f : fields_) {
    parts = std::max(parts,
                     count_sub_motions(*used, in_frame(f.grid().axis, motion), sweep_settings(f)));
  }
  if (parts > kSubMotionsMax) {
    return reject(
        kTooManySubMotions,
        "the motion needs more than 2^20 sub-motions; increase tolerance_mm or divide it");
  }
  return {};
}

Wrench Sculpture::collision(ToolId id, const ToolPose& pose) const {
  const Tool* used = tool(id);
  if (used == nullptr || !check_pose("the", pose)) return {};
  return collision(*used, {pose.tip_mm, normalized(pose.axis)});
}

Wrench Sculpture::collision(const Tool& tool, const ToolPose& pose) const {
  Wrench sum;
  if (obstacles_) sum = obstacles_->push(tool, pose, settings_.force.pivot_mm);
  if (tool.non_cutting.empty()) return sum;
  return sum + stock_contact(tool, pose, fields_, settings_.force, settings_.tolerance_mm).wrench;
}

std::vector<ContactPlane> Sculpture::contact(ToolId id, const ToolPose& given, bool cutting) const {
  std::vector<ContactPlane> planes;
  const Tool* used = tool(id);
  if (used == nullptr || !check_pose("the", given)) return planes;
  const ToolPose pose{given.tip_mm, normalized(given.axis)};
  if (obstacles_) obstacles_->planes(*used, pose, planes);
  stock_planes(cutting ? used->non_cutting_parts : used->whole_parts, pose, fields_,
               settings_.force, settings_.tolerance_mm, planes);
  std::ranges::stable_sort(planes, std::greater{}, &ContactPlane::depth_mm);
  return planes;
}

std::expected<MotionResult, SculptureError> Sculpture::apply(const Command& command) {
  SerialWorkers alone;
  return apply(command, alone);
}

std::expected<MotionResult, SculptureError> Sculpture::apply(const Command& command,
                                                             Workers& workers) {
  if (auto c = check(command); !c) return std::unexpected(c.error());
  if (const auto* define = std::get_if<DefineTool>(&command)) {
    // Rebuilt from its pieces, so that a tool from a journal equals the same tool from a scene.
    engagements_->forget(define->id);
    tools_[define->id] = *make_tool(define->tool.pieces, define->tool.non_cutting);
    last_pose_.erase(define->id);
    return MotionResult{};
  }
  return std::move(apply({&std::get<MoveTool>(command), 1}, workers).front());
}

SweepSettings Sculpture::sweep_settings(const DexelField& field) const {
  return {settings_.motion, settings_.tolerance_mm, ray_bounds(field.grid())};
}

std::int64_t Sculpture::take_imprint(const DexelField& field, const Tool& tool,
                                     const ToolPose& start) {
  if (removal_->quanta() == 0) return 0;
  std::int64_t quanta = 0;
  const ToolMotion rest = in_frame(field.grid().axis, make_motion(start, start, tool.length_mm));
  sweep_tool(tool, rest, sweep_settings(field), [&](const SubMotion& standing) {
    for (RemovedPart& part : removal_->parts()) {
      quanta += kerf::take_imprint(standing.swept, field.grid(), part);
    }
  });
  return quanta;
}

std::vector<MotionResult> Sculpture::apply(std::span<const MoveTool> motions, Workers& workers,
                                           const AfterMotion& after) {
  return window_->apply(*this, motions, workers, after);
}

void Sculpture::count_motion(std::span<const RemovedVolume> removed, MotionResult& result) {
  result.removed_mm3 = combined_mm3(removed, &RemovedVolume::mm3);
  result.imprint_mm3 = combined_mm3(removed, &RemovedVolume::imprint_mm3);
  std::erase_if(result.changed_tiles, [this](TileIndex tile) { return !grid().has(tile); });
  std::ranges::sort(result.changed_tiles);
  const auto repeated = std::ranges::unique(result.changed_tiles);
  result.changed_tiles.erase(repeated.begin(), repeated.end());
  removed_mm3_ += result.removed_mm3;
  imprint_mm3_ += result.imprint_mm3;
  ++motions_;
  sub_motions_ += result.sub_motions;
}

}  // namespace kerf
