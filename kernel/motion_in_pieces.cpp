// SPDX-License-Identifier: Apache-2.0
// The part of Sculpture that applies a motion piece by piece.
#include "kernel/motion_in_pieces.h"

#include <algorithm>
#include <utility>

#include "kernel/cut/changed_tiles.h"
#include "kernel/cut/cut.h"
#include "kernel/cut/lazy_normals.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/tile_region.h"
#include "kernel/force/engagement.h"
#include "kernel/force/stock_contact.h"
#include "kernel/motion_reach.h"
#include "kernel/sculpture.h"
#include "kernel/sculpture_motion.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

struct MotionInPieces::State {
  ToolId id = 0;
  Tool tool;
  ToolMotion motion;
  MotionStart start{};
  MotionResult result = {};
  std::vector<RemovedVolume> removed = {};  ///< from the fields that are finished
  std::vector<SubMotion> parts = {};        ///< of the field that is being cut
  bool has_parts = false;
  std::size_t part = 0;
  std::int64_t tile = 0;  ///< the next one in the bounds of the part
  std::int64_t quanta = 0, imprint = 0, elements = 0, sub_motions = 0;
  double border = 0, border_imprint = 0;  ///< additional quanta, by the shares of the columns
};

MotionInPieces::MotionInPieces(std::unique_ptr<State> state) : state_(std::move(state)) {}
MotionInPieces::MotionInPieces(MotionInPieces&&) noexcept = default;
MotionInPieces& MotionInPieces::operator=(MotionInPieces&&) noexcept = default;
MotionInPieces::~MotionInPieces() = default;

std::int64_t Sculpture::tiles_in_reach(const MoveTool& command) const {
  const Tool* used = tool(command.tool);
  if (used == nullptr) return 0;
  const Bounds box = reach_of(*used, motion_of(command, *used));
  std::int64_t tiles = 0;
  for (const DexelField& f : fields_)
    tiles += tiles_through(f.grid(), box.lo_mm, box.hi_mm).count();
  return tiles;
}

std::expected<MotionInPieces, SculptureError> Sculpture::begin(const MoveTool& command) {
  if (auto c = check_move(command); !c) return std::unexpected(c.error());
  const Tool& used = tools_.at(command.tool);
  const ToolMotion motion = motion_of(command, used);
  const ToolPose end{command.to.tip_mm, normalized(command.to.axis)};
  const bool continues = engagements_->follow(command.tool, motion.from, end, false).continues;
  const auto last = last_pose_.find(command.tool);
  auto state = std::make_unique<MotionInPieces::State>(MotionInPieces::State{
      .id = command.tool,
      .tool = used,
      .motion = motion,
      .start = {last != last_pose_.end() && last->second == motion.from, continues}});
  state->result.kind = motion.kind;
  return MotionInPieces(std::move(state));
}

std::optional<MotionResult> Sculpture::advance(MotionInPieces& pieces, std::int64_t tiles) {
  MotionInPieces::State& s = pieces.state();
  while (s.removed.size() < fields_.size()) {
    DexelField& field = fields_[s.removed.size()];
    if (!std::exchange(s.has_parts, true)) {
      SweepSettings settings = sweep_settings(field);
      settings.start_is_cut = s.start.is_cut;
      sweep_tool(s.tool, in_frame(field.grid().axis, s.motion), settings,
                 [&s](const SubMotion& part) { s.parts.push_back(part); });
    }
    while (s.part < s.parts.size()) {
      if (tiles <= 0) {
        // Its sweeps reach many tiles. If they were left pending, the next snapshot would have to
        // resolve all.
        normals_[s.removed.size()].resolve(field);
        return std::nullopt;
      }
      tiles -= cut_piece(s, tiles);
    }
    const double quantum_mm3 = field.grid().quantum_mm3();
    s.removed.push_back({(static_cast<double>(s.quanta) + s.border) * quantum_mm3,
                         (static_cast<double>(s.imprint) + s.border_imprint) * quantum_mm3,
                         static_cast<double>(s.elements)});
    s.result.sub_motions =
        std::max(s.result.sub_motions, static_cast<std::uint32_t>(s.sub_motions));
    s.parts.clear();
    s.has_parts = false;
    s.part = 0;
    s.quanta = s.imprint = s.elements = s.sub_motions = 0;
    s.border = s.border_imprint = 0;
  }
  return finish(s);
}

std::int64_t Sculpture::cut_piece(MotionInPieces::State& s, std::int64_t tiles) {
  const std::size_t n = s.removed.size();
  DexelField& field = fields_[n];
  const SubMotion& part = s.parts[s.part];
  const TileRun run{s.tile, tiles};
  const std::int64_t in_bounds = cut(field, normals_[n], s.tool, part, *removal_, run);
  const std::int64_t done = std::min(tiles, in_bounds - s.tile);
  const double border = removal_->border(field.shares());
  s.quanta += removal_->quanta();
  s.border += border;
  if (fields_.size() > 1) s.elements += removal_->elements();
  for (const RemovedPart& removed : removal_->parts()) {
    for (std::size_t t = 0; t < removed.tiles.size(); ++t) {
      const TileIndex tile = removed.tiles[t].index;
      append_changed_tiles(field.grid(), tile, depths_of(removed.of(t)), s.result.changed_tiles);
      s.result.cut_tiles.push_back({field.grid().axis, tile});
    }
  }
  if (s.sub_motions == 0 && !s.start.continues) {
    s.imprint += take_imprint(field, s.tool, s.motion.from);
    s.border_imprint += border - removal_->border(field.shares());
  }
  s.tile += done;
  if (s.tile >= in_bounds) {
    s.sub_motions += part.count;
    s.tile = 0;
    ++s.part;
  }
  return std::max<std::int64_t>(done, 1);
}

MotionResult Sculpture::finish(MotionInPieces::State& s) {
  last_pose_[s.id] = s.motion.to;
  MotionResult result = std::move(s.result);
  count_motion(s.removed, result);
  if (!s.tool.non_cutting.empty()) {
    result.stock_contact_mm =
        deepest_stock_contact(s.tool, s.motion, fields_, settings_.tolerance_mm);
  }
  return result;
}

}  // namespace kerf
