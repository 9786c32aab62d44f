// SPDX-License-Identifier: Apache-2.0
#include "kernel/tile_carver.h"

#include <algorithm>
#include <utility>

#include "kernel/cut/cut.h"
#include "kernel/cut/lazy_normals.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/sculpture_motion.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

/// One field of rays.
struct TileCarver::Layer {
  DexelField field;
  LazyNormals normals;
};

TileCarver::TileCarver(const SculptureSettings& settings, const SolidSnapshot& start)
    : motion_model_(settings.motion),
      tolerance_mm_(settings.tolerance_mm),
      start_(start),
      removal_(std::make_unique<Removal>()) {
  for (const DexelSnapshot& field : start_.fields) {
    layers_.push_back(
        {DexelField(field.stock(), settings.pitch_mm, field.grid().axis, settings.keep_normals),
         {}});
    layers_.back().field.restore(field);
  }
}

TileCarver::TileCarver(TileCarver&&) noexcept = default;
TileCarver::~TileCarver() = default;

TileCarver::Layer& TileCarver::layer(RayAxis axis) {
  return *std::ranges::find(layers_, axis, [](const Layer& l) { return l.field.grid().axis; });
}

const TileCarver::Layer& TileCarver::layer(RayAxis axis) const {
  return *std::ranges::find(layers_, axis, [](const Layer& l) { return l.field.grid().axis; });
}

void TileCarver::begin(FieldTile at, const std::shared_ptr<const DexelTile>& tile) {
  DexelField& field = layer(at.axis).field;
  field.put_shared(at.tile, tile);
  field.put(at.tile, field.fresh(at.tile));
}

const DexelTile* TileCarver::find(FieldTile at) const { return layer(at.axis).field.find(at.tile); }

std::shared_ptr<DexelTile> TileCarver::copy_of_start(FieldTile at) const {
  std::shared_ptr<DexelTile> tile = layer(at.axis).field.fresh(at.tile);
  tile->era = 0;  // eras begin at 1, so no field owns it
  return tile;
}

void TileCarver::cut(const Tool& tool, const ToolMotion& motion, std::span<const FieldTile> tiles,
                     bool start_is_cut) {
  for (auto first = tiles.begin(); first != tiles.end();) {
    const RayAxis axis = first->axis;
    tiles_.clear();
    for (; first != tiles.end() && first->axis == axis; ++first) tiles_.push_back(first->tile);
    Layer& at = layer(axis);
    const SweepSettings settings{motion_model_, tolerance_mm_, ray_bounds(at.field.grid()),
                                 start_is_cut};
    sweep_tool(tool, in_frame(axis, motion), settings, [&](const SubMotion& part) {
      cut_tiles(at.field, at.normals, tool, part, tiles_, *removal_);
    });
  }
}

std::shared_ptr<const DexelTile> TileCarver::take(FieldTile at) {
  Layer& from = layer(at.axis);
  from.normals.resolve(from.field);
  std::shared_ptr<DexelTile> tile = from.field.take(at.tile);
  if (!tile) return nullptr;
  from.field.put_shared(at.tile, start(at));
  tile->era = 0;  // eras begin at 1, so no field owns it
  return tile;
}

std::shared_ptr<const DexelTile> TileCarver::start(FieldTile at) const {
  const auto field = std::ranges::find(start_.fields, at.axis,
                                       [](const DexelSnapshot& f) { return f.grid().axis; });
  return field->tiles().share(at.tile);
}

}  // namespace kerf
