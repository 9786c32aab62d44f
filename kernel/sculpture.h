#pragma once

#include <cstdint>
#include <expected>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/force/force_settings.h"
#include "kernel/force/obstacle.h"
#include "kernel/force/wrench.h"
#include "kernel/sweep/motion_kind.h"
#include "kernel/tool/tool.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

class DexelField;
class Obstacles;
struct ToolMotion;

struct SculptureSettings {
  StockShape stock;
  double pitch_mm = 0.25;
  double tolerance_mm = 0.01;  ///< greatest end-point error of MotionModel::kTight and kPaper
  MotionModel motion = MotionModel::kTight;
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

/// What an agent needs to render the cut between two results from its own velocity (design section
/// 7).
struct CuttingModel {
  double engaged_area_mm2 = 0;  ///< A = removed volume / path length
  Vec3 direction;               ///< unit direction of the cutting force; zero when nothing was cut
  Vec3 center_mm;               ///< volume centre of what was removed
};

struct MotionResult {
  MotionKind kind = MotionKind::kRest;
  Wrench wrench;     ///< cutting + collision
  Wrench collision;  ///< the collision part alone
  CuttingModel cutting;
  double removed_mm3 = 0;
  std::uint32_t sub_motions = 0;
  std::vector<TileIndex> changed_tiles;  ///< sorted, without duplicates
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
/// Positions farther than this from the origin are refused.
inline constexpr double kCoordinateMaxMm = 1e6;
/// Most columns that one field may have.
inline constexpr std::int64_t kColumnsMax = std::int64_t{1} << 32;

/// The deterministic state machine: equal settings and equal commands give equal bytes, on any CPU,
/// at any optimisation level. A command that is refused leaves it as it was. Not thread-safe: one
/// executor owns it; snapshots may be read anywhere.
class Sculpture {
 public:
  static std::expected<Sculpture, SculptureError> create(SculptureSettings settings);
  Sculpture(Sculpture&&) noexcept;
  Sculpture& operator=(Sculpture&&) noexcept;
  ~Sculpture();

  /// Applies one command. DefineTool gives an empty result; a tool may be redefined.
  std::expected<MotionResult, SculptureError> apply(const Command& command);
  /// What apply would refuse, without changing anything: the session checks before it journals.
  std::expected<void, SculptureError> check(const Command& command) const;

  /// F_collision and τ_collision of a tool that stands at a pose without cutting (N, N·mm about the
  /// pivot); zero in a scene without obstacles, for an unknown tool, and for a pose that a motion
  /// to it would be refused for.
  Wrench collision(ToolId tool, const ToolPose& pose) const;

  const SculptureSettings& settings() const { return settings_; }
  const DexelGrid& grid() const;
  const Tool* tool(ToolId id) const;  ///< null if not defined
  /// A picture of the block as it is now; O(tiles), copies no column.
  DexelSnapshot snapshot();
  /// Hash of the solid (DexelSnapshot::hash): what replay, peers and tests compare.
  std::uint64_t state_hash();
  double stock_volume_mm3() const { return stock_volume_mm3_; }
  double removed_volume_mm3() const { return removed_mm3_; }
  std::uint64_t motions() const { return motions_; }
  std::uint64_t sub_motions() const { return sub_motions_; }

 private:
  explicit Sculpture(SculptureSettings settings);
  std::expected<void, SculptureError> check_move(const MoveTool& command) const;
  MotionResult move(const MoveTool& command);

  SculptureSettings settings_;
  std::unique_ptr<DexelField> field_;
  std::unique_ptr<Obstacles> obstacles_;  ///< null in a scene without any
  std::map<ToolId, Tool> tools_;
  double stock_volume_mm3_ = 0;
  double removed_mm3_ = 0;
  std::uint64_t motions_ = 0;
  std::uint64_t sub_motions_ = 0;
};

}  // namespace kerf
