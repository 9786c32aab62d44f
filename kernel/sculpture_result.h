// SPDX-License-Identifier: Apache-2.0
#pragma once

// The result of a motion: force, contact, removed volume and changed tiles.

#include <compare>
#include <cstdint>
#include <memory>
#include <vector>

#include "kernel/dexel/tile_index.h"
#include "kernel/math/ray_axis.h"
#include "kernel/math/vec3.h"
#include "kernel/math/wrench.h"
#include "kernel/sculpture_command.h"
#include "kernel/sweep/motion_kind.h"

namespace kerf {

struct DexelTile;

/// A local model of the cut, from which a haptic device renders the cutting force between two
/// results as a function of its own velocity.
struct CuttingModel {
  /// Engaged area A = delivered volume / path length (kernel/force/README.md).
  double engaged_area_mm2 = 0;
  Vec3 direction;  ///< unit direction of the cutting force; zero where nothing was cut
  Vec3 center_mm;  ///< centroid of the removed volume
};

/// Names a tile of one of the fields.
struct FieldTile {
  RayAxis axis = RayAxis::kZ;
  TileIndex tile;
  friend constexpr auto operator<=>(const FieldTile&, const FieldTile&) = default;
};

/// The result of Sculpture::apply. For a DefineTool, all members have their default values.
struct MotionResult {
  MotionKind kind = MotionKind::kRest;
  /// Mean cutting wrench over the motion plus `collision`; N, N·mm about the tool's pivot.
  Wrench wrench;
  /// Wrench from obstacles and from stock against shank and holder at the motion's end pose.
  Wrench collision;
  CuttingModel cutting;
  /// Greatest depth of shank or holder in the stock along the motion.
  double stock_contact_mm = 0;
  /// Volume removed by this motion. With three fields, their direction-weighted mean
  /// (kernel/dexel/README.md).
  double removed_mm3 = 0;
  /// The part of `removed_mm3` that was inside the tool where the motion began. A tool that appears
  /// inside stock removes it without force. Exactly 0 if a motion of the same tool ended at that
  /// pose (kernel/force/README.md, "Imprint").
  double imprint_mm3 = 0;
  /// Number of cuts into which the motion was divided: the greatest over the fields.
  std::uint32_t sub_motions = 0;
  /// Tiles of the field along Z whose surface changed; sorted, without duplicates.
  std::vector<TileIndex> changed_tiles;
  /// Tiles of any field that lost material; may contain duplicates.
  std::vector<FieldTile> cut_tiles;
};

/// A tile as a different set of motions leaves it (TileCarver).
struct TileReplacement {
  FieldTile at;
  std::shared_ptr<const DexelTile> tile;  ///< null: untouched stock
};

/// A motion that a block holds and a replacement does not.
struct MotionSince {
  const Tool* tool = nullptr;
  MoveTool move;
};

/// The result of Sculpture::replace.
struct ReplacedTiles {
  /// Restored volume minus removed volume. With three fields, the mean of their values.
  double returned_mm3 = 0;
  std::vector<TileIndex> changed_tiles;  ///< as in MotionResult
  std::vector<FieldTile> tiles;          ///< those that differ from before, in the order given
};

}  // namespace kerf
