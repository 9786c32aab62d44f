// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/dexel/stop_asked.h"
#include "kernel/dexel/tile_columns.h"
#include "kernel/force/contact_plane.h"
#include "kernel/math/wrench.h"
#include "kernel/motion_in_pieces.h"
#include "kernel/sculpture_command.h"
#include "kernel/sculpture_error.h"
#include "kernel/sculpture_result.h"
#include "kernel/sculpture_settings.h"

namespace kerf {

class DexelField;
class Engagements;
class Obstacles;
class LazyNormals;
class MotionWindow;
class Removal;
class Workers;
struct RemovedVolume;
struct SculptureState;
struct SweepSettings;

/// A block of stock that tools carve: a deterministic state machine. Equal settings and equal
/// commands give equal bytes on any CPU, at any optimization level and with any number of workers.
/// A rejected command leaves the state unchanged. Not thread-safe: one executor owns a Sculpture.
/// The snapshots that it returns may be read on any thread while it changes.
///
/// Based on W. Zhu and Y.-S. Lee, Dexel-based force–torque rendering and volume updating for 5-DOF
/// haptic product prototyping and virtual sculpting, Computers in Industry 55 (2004).
/// tests/paper/page.md lists where each equation is implemented.
class Sculpture {
 public:
  /// Builds the block. Returns an error for the first setting that is out of range
  /// (sculpture_settings.h), or kStopped if a stop was asked while a mesh was converted.
  static std::expected<Sculpture, SculptureError> create(SculptureSettings settings,
                                                         const StopAsked& stop_asked = {});
  Sculpture(Sculpture&&) noexcept;
  Sculpture& operator=(Sculpture&&) noexcept;
  ~Sculpture();

  /// Applies one command, or returns why it was rejected. A large motion is divided among
  /// `workers`; the result does not depend on them.
  std::expected<MotionResult, SculptureError> apply(const Command& command, Workers& workers);
  /// Applies one command on the calling thread.
  std::expected<MotionResult, SculptureError> apply(const Command& command);
  /// Called with the number of a motion and its result, in order, on the calling thread. Within
  /// reach of the shank and holder of its tool, the stock is that after the motion.
  using AfterMotion = std::function<void(std::size_t, const MotionResult&)>;
  /// Applies motions, which must pass check(), one after the other, and returns their results.
  /// Short motions gain from several workers only if several are applied together.
  std::vector<MotionResult> apply(std::span<const MoveTool> motions, Workers& workers,
                                  const AfterMotion& after = {});
  /// Returns how many tiles, over all fields, are in the bounds of the motion's sweep: an upper
  /// bound of those that it may change. The command must pass check().
  std::int64_t tiles_in_reach(const MoveTool& command) const;
  /// Begins a motion that is cut piece by piece, because it reaches many tiles. Nothing is cut yet.
  /// Other commands, except a DefineTool of its tool, may be applied between the pieces. Cuts
  /// commute, so the solid is the same, to the bit, as if the motion had been applied at once. So
  /// is the result, except that it has no force and no contact: such a motion is not felt.
  std::expected<MotionInPieces, SculptureError> begin(const MoveTool& command);
  /// Cuts the next tiles in the bounds of the motion, at most `tiles` >= 1. Returns the result once
  /// the motion is complete. Until then the solid holds a part of the motion that counters and
  /// tools' poses do not show. Every motion that was begun must be completed.
  std::optional<MotionResult> advance(MotionInPieces& motion, std::int64_t tiles);
  /// Returns the error that `apply` would return, without changing anything: a session calls it
  /// before it writes a command to its journal.
  std::expected<void, SculptureError> check(const Command& command) const;

  /// Computes the collision wrench F_collision, τ_collision (N, N·mm about the pivot) of a tool at
  /// rest: from obstacles, and from stock against its shank and holder. Zero for an unknown tool
  /// and for a pose that `apply` rejects.
  Wrench collision(ToolId tool, const ToolPose& pose) const;

  /// Returns the contact planes of a tool at a pose, deepest first: of obstacles nearer than
  /// kContactReachMm, of the stock against shank and holder, and, unless `cutting`, of the stock
  /// against the cutting part. Empty for an unknown tool and for a pose that `apply` rejects.
  std::vector<ContactPlane> contact(ToolId tool, const ToolPose& pose, bool cutting) const;

  const SculptureSettings& settings() const { return settings_; }
  /// Returns the grid of the field along Z.
  const DexelGrid& grid() const;
  /// Returns a tool, or null if it is not defined. Valid until that tool is redefined.
  const Tool* tool(ToolId id) const;
  /// Returns whether there are rays along an axis.
  bool has_field(RayAxis axis) const { return field(axis) != nullptr; }
  /// Returns the field along an axis, or null if there is none. Its normals may still be pending;
  /// `snapshot` resolves them.
  const DexelField* field(RayAxis axis) const;

  /// Removes from a tile everything that another copy of the block no longer holds
  /// (tile_columns.h). This is not a motion: it changes no volume counter and produces no force.
  /// Ignored if the tile is outside the grid. If normals are kept, new ends get estimated ones
  /// (estimated_normals.h).
  void keep_common(FieldTile at, const TileColumns& other);

  /// Replaces tiles of existing fields, within their grids, and cuts them with the motions `since`.
  /// Undoing a motion uses this to restore stock. It is not a motion: removed_volume_mm3() falls by
  /// the restored volume, and the counters of motions stay. Tools that reach a changed tile lose
  /// their pending force, and their next motion continues no earlier one: stock restored around a
  /// tool is imprint to it, not a cut that is felt.
  ReplacedTiles replace(std::span<const TileReplacement> tiles,
                        std::span<const MotionSince> since = {});
  /// Returns whether the cutting part of a tool at rest at a pose would remove anything. False for
  /// an unknown tool, and, to the bit, at the end of a motion of the same tool. Costs as much as
  /// such a cut.
  bool is_in_stock(ToolId tool, const ToolPose& pose) const;

  /// Returns an immutable view of one field, which must exist. Copies no column. Resolves pending
  /// normals first.
  DexelSnapshot snapshot(RayAxis axis = RayAxis::kZ);
  /// Returns an immutable view of all fields.
  SolidSnapshot solid();
  /// Returns the state after the last command. It copies no column and may be read on any thread
  /// while the block changes. No motion may be partly applied (begin).
  SculptureState state();
  /// Replaces the present state by one that state() returned for equal settings. Returns false,
  /// without a change, if the state has different rays.
  bool restore(const SculptureState& state);
  /// Replaces the stock by that of a block with equal settings, as solid() returned it. Tools,
  /// their poses, pending force and counters stay, so a trial copy of a block can be reset while
  /// its user keeps feeling the tool. Returns false, without a change, if the block has different
  /// rays.
  bool restore(const SolidSnapshot& solid);
  /// Hashes the solid over all fields; O(touched tiles). Replays, replicas and tests compare it.
  std::uint64_t state_hash() { return solid().hash(); }
  /// Returns the bytes that all fields hold; O(touched tiles).
  std::size_t memory_bytes() const;
  /// Returns the bytes of the buffers that cuts reuse for the normals of the surface.
  std::size_t working_bytes() const;

  /// Returns the volume of the stock before the first cut, mm³. With three fields, their mean.
  double stock_volume_mm3() const { return stock_volume_mm3_; }
  /// Returns the sum of MotionResult::removed_mm3 over all motions.
  double removed_volume_mm3() const { return removed_mm3_; }
  /// Returns the sum of MotionResult::imprint_mm3 over all motions, a part of the removed volume.
  double imprint_volume_mm3() const { return imprint_mm3_; }
  /// Returns the number of motions applied.
  std::uint64_t motions() const { return motions_; }
  /// Returns the sum of MotionResult::sub_motions over all motions.
  std::uint64_t sub_motions() const { return sub_motions_; }

 private:
  friend class MotionWindow;
  Sculpture(SculptureSettings settings, const StopAsked& stop_asked);
  std::expected<void, SculptureError> check_move(const MoveTool& command) const;
  Wrench collision(const Tool& tool, const ToolPose& pose) const;
  /// Removes the imprint of the tool at the start of a motion from the elements that the motion
  /// removed from a field. Returns its length in quanta.
  std::int64_t take_imprint(const DexelField& field, const Tool& tool, const ToolPose& start);
  void forget_users(const FieldTile& at);
  /// Cuts tiles of one field.
  void cut_again(std::size_t field, std::span<const TileIndex> tiles, const MotionSince& motion);
  /// Cuts at most this many tiles of the current part of a motion. Returns how many.
  std::int64_t cut_piece(MotionInPieces::State& state, std::int64_t tiles);
  MotionResult finish(MotionInPieces::State& state);
  /// Sets the volumes of a finished motion, sorts its tiles, and counts it.
  void count_motion(std::span<const RemovedVolume> removed, MotionResult& result);
  SweepSettings sweep_settings(const DexelField& field) const;
  /// Returns the index in fields_ of a field, which must exist.
  std::size_t place_of(RayAxis axis) const;

  SculptureSettings settings_;
  std::vector<DexelField> fields_;        ///< along Z; then along X and Y if Rays::kTriDexel
  std::vector<LazyNormals> normals_;      ///< of each field
  std::unique_ptr<Obstacles> obstacles_;  ///< null in a scene without obstacles
  std::unique_ptr<Engagements> engagements_;
  std::unique_ptr<Removal> removal_;  ///< this and the next reuse their memory
  std::unique_ptr<MotionWindow> window_;
  std::map<ToolId, Tool> tools_;
  std::map<ToolId, ToolPose> last_pose_;  ///< end of each tool's last motion
  double stock_volume_mm3_ = 0;
  double removed_mm3_ = 0;
  double imprint_mm3_ = 0;
  std::uint64_t motions_ = 0;
  std::uint64_t sub_motions_ = 0;
};

}  // namespace kerf
