// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/dexel/tile_columns.h"
#include "kernel/dexel/triangle_mesh.h"
#include "kernel/force/contact_plane.h"
#include "kernel/force/force_settings.h"
#include "kernel/force/obstacle.h"
#include "kernel/math/wrench.h"
#include "kernel/sweep/motion_kind.h"
#include "kernel/tool/tool.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

class CuttingForce;
class DexelField;
class Engagements;
class Obstacles;
class OwedNormals;
class Removal;
class Workers;
struct RemovedVolume;
struct SweepSettings;
struct ToolMotion;

/// Along which axes rays measure the stock. One field along Z (the paper's) is cheapest and blind
/// to the exact place of walls parallel to Z; three fields along X, Y and Z see every surface, at
/// 3.5 times the cost or more (kernel/README.md, "Speed").
enum class Rays : std::uint8_t { kDexel, kTriDexel };
/// "dexel", "tri-dexel".
const char* to_string(Rays rays);

struct SculptureSettings {
  StockShape stock;
  /// The solid within a mesh (kernel/dexel/mesh_stock.h) instead; `stock` is then not looked at.
  /// Not held once the block is made.
  std::shared_ptr<const TriangleMesh> stock_mesh;
  Rays rays = Rays::kDexel;
  double pitch_mm = 0.25;
  double tolerance_mm = 0.01;  ///< greatest end-point error of MotionModel::kTight and kPaper
  MotionModel motion = MotionModel::kTight;
  /// Keep with each end of each element how the surface looks there: what meshes are made of. Takes
  /// as much memory again as the elements, and time for each end that a motion moves.
  bool keep_normals = true;
  ForceSettings force;
  std::vector<Obstacle> obstacles;
};

/// Names a tool within one sculpture.
using ToolId = std::uint32_t;

struct DefineTool {
  ToolId id = 0;
  Tool tool;
};
/// Moves a tool from one pose to the next: the tip on a straight line, the axis on the great
/// circle, both uniformly.
struct MoveTool {
  ToolId tool = 0;
  ToolPose from, to;
  double duration_s = 0;  ///< >= 0; only the force depends on it, and there is none at 0
  bool feel = true;       ///< false: nobody feels this motion, no force is computed
};
/// The only way to change a Sculpture; what a journal records.
using Command = std::variant<DefineTool, MoveTool>;

/// What an agent needs to render the cut between two results from its own velocity.
struct CuttingModel {
  double engaged_area_mm2 = 0;  ///< A = felt volume / path length (kernel/README.md, "Force")
  Vec3 direction;               ///< unit direction of the cutting force; zero when nothing was cut
  Vec3 center_mm;               ///< volume centre of what was removed
};

/// A tile of one of the fields.
struct FieldTile {
  RayAxis axis = RayAxis::kZ;
  TileIndex tile;
  friend constexpr auto operator<=>(const FieldTile&, const FieldTile&) = default;
};

struct MotionResult {
  MotionKind kind = MotionKind::kRest;
  Wrench wrench;     ///< cutting + collision
  Wrench collision;  ///< the collision part alone
  CuttingModel cutting;
  double stock_contact_mm = 0;    ///< deepest that shank or holder were in the stock on the way
  double removed_mm3 = 0;         ///< of three fields: direction-weighted (kernel/README.md)
  std::uint32_t sub_motions = 0;  ///< cuts made, in all fields together
  std::vector<TileIndex> changed_tiles;  ///< whose surface changed; sorted, without duplicates
  std::vector<FieldTile> cut_tiles;  ///< that lost something, in any field; repeats are possible
};

enum class SculptureErrorCode {
  kBadStock,
  kBadPitch,
  kTooManyColumns,
  kBadTolerance,
  kBadForce,
  kBadObstacle,
  kUnknownTool,
  kBadTool,
  kNotFinite,
  kBadAxis,
  kTurnTooLarge,
  kOutOfRange,
  kBadDuration,
  kTooManySubMotions
};
struct SculptureError {
  SculptureErrorCode code;
  std::string reason;  ///< one sentence, with the offending field and value
};
/// The name of a code as the wire and the command line write it, e.g. "turn_too_large".
const char* to_string(SculptureErrorCode code);

/// A motion may turn the axis by at most this much (design section 3).
inline constexpr double kTurnMaxRad = 170 * 3.14159265358979323846 / 180;
/// Positions farther than this from the origin are rejected.
inline constexpr double kCoordinateMaxMm = 1e6;
/// A stock whose sides are shorter than this is rejected.
inline constexpr double kStockSizeMinMm = 1e-4;
/// Most columns that one field may have.
inline constexpr std::int64_t kColumnsMax = std::int64_t{1} << 36;
/// Most columns of a field whose stock is a mesh, since most of its tiles are stored.
inline constexpr std::int64_t kMeshColumnsMax = std::int64_t{1} << 28;

/// The deterministic state machine: equal settings and equal commands give equal bytes, on any CPU,
/// at any optimisation level. A command that is rejected leaves it as it was. Not thread-safe: one
/// executor owns it; snapshots may be read anywhere.
class Sculpture {
 public:
  static std::expected<Sculpture, SculptureError> create(SculptureSettings settings);
  Sculpture(Sculpture&&) noexcept;
  Sculpture& operator=(Sculpture&&) noexcept;
  ~Sculpture();

  /// Applies one command. DefineTool gives an empty result; a tool may be redefined. A motion that
  /// is much work is divided among `workers`, with the same result, to the bit.
  std::expected<MotionResult, SculptureError> apply(const Command& command, Workers& workers);
  std::expected<MotionResult, SculptureError> apply(const Command& command);
  /// What apply would reject, without changing anything: the session checks before it journals.
  std::expected<void, SculptureError> check(const Command& command) const;

  /// F_collision and τ_collision of a tool that stands at a pose without cutting, from obstacles
  /// and from stock against its shank and holder (N, N·mm about the pivot); zero for an unknown
  /// tool, and for a pose that a motion to it would be rejected for.
  Wrench collision(ToolId tool, const ToolPose& pose) const;

  /// What pushes a tool at a pose, or is about to: obstacles nearer than kContactReachMm; the stock
  /// against shank and holder, and against the cutting part as well unless the tool is `cutting`.
  /// Deepest first; none for an unknown tool or a pose that would be rejected.
  std::vector<ContactPlane> contact(ToolId tool, const ToolPose& pose, bool cutting) const;

  const SculptureSettings& settings() const { return settings_; }
  const DexelGrid& grid() const;      ///< of the field along Z
  const Tool* tool(ToolId id) const;  ///< null if not defined
  /// Whether there are rays along this axis.
  bool has_field(RayAxis axis) const { return field(axis) != nullptr; }
  /// The field along an axis as it is now, whose normals may be owed still (snapshot pays them);
  /// null where there is none.
  const DexelField* field(RayAxis axis) const;
  /// Takes from a tile what another copy of the block lacks (tile_columns.h). That is no motion: it
  /// counts in no volume and gives no force. Nothing happens to a tile that is not in the block.
  /// Normals of ends that this makes are the stock's, so it is for blocks that keep none.
  void keep_common(FieldTile at, const TileColumns& other);
  /// A picture of one field as it is now; O(tiles), copies no column. The field must exist.
  DexelSnapshot snapshot(RayAxis axis = RayAxis::kZ);
  /// A picture of all fields.
  SolidSnapshot solid();
  /// Hash of the solid, over every field: what replay, peers and tests compare.
  std::uint64_t state_hash() { return solid().hash(); }
  /// Memory that the block holds, in all fields; walks the touched tiles.
  std::size_t memory_bytes() const;
  /// Of three fields: the mean of theirs.
  double stock_volume_mm3() const { return stock_volume_mm3_; }
  double removed_volume_mm3() const { return removed_mm3_; }
  std::uint64_t motions() const { return motions_; }
  std::uint64_t sub_motions() const { return sub_motions_; }

 private:
  explicit Sculpture(SculptureSettings settings);
  std::expected<void, SculptureError> check_move(const MoveTool& command) const;
  MotionResult move(const MoveTool& command, Workers& workers);
  Wrench collision(const Tool& tool, const ToolPose& pose) const;
  /// Cuts one field and notes in `result` and `force` (null: not felt) what that took.
  RemovedVolume cut_field(DexelField& field, OwedNormals& normals, const Tool& tool,
                          const ToolMotion& motion, bool start_is_cut, MotionResult& result,
                          CuttingForce* force, Workers& workers);
  SweepSettings sweep_settings(const DexelField& field) const;

  SculptureSettings settings_;
  std::vector<DexelField> fields_;        ///< along Z; then along X and Y, if asked for
  std::vector<OwedNormals> normals_;      ///< of each field
  std::unique_ptr<Obstacles> obstacles_;  ///< null in a scene without any
  std::unique_ptr<Engagements> engagements_;
  std::unique_ptr<Removal> removal_;  ///< of the last sub-motion; kept for its memory
  std::map<ToolId, Tool> tools_;
  std::map<ToolId, ToolPose> last_pose_;  ///< where each tool has been removed from the block last
  double stock_volume_mm3_ = 0;
  double removed_mm3_ = 0;
  std::uint64_t motions_ = 0;
  std::uint64_t sub_motions_ = 0;
};

}  // namespace kerf
