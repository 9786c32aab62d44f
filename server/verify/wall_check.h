// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/formats/program.h"
#include "server/formats/scene.h"
#include "server/verify/thin_walls.h"

namespace kerf {

/// Requirement of a target error at thin walls, grooves and sharp edges.
struct WallTargetResult {
  double target_mm;                ///< of the scene
  std::optional<double> pitch_mm;  ///< greatest pitch that keeps them (pitch_for_walls), if any
  bool complete;                   ///< false: the search reached its effort limit
};

/// Walls and grooves of a program's result that are thinner than the pitch of the rays.
struct WallReport {
  double pitch_mm = 0;
  double spacing_mm = 0;        ///< of the samples (CutSurface::spacing_mm)
  std::vector<ThinWall> walls;  ///< one for each pair of program lines; thinnest first
  bool complete = true;         ///< false: the search reached its effort limit
  std::optional<WallTargetResult> target = {};  ///< set by the caller
};

/// Returns a suitable number of candidates for a program: one for four motions, 1000 to 10000 (at
/// least 4000 if the stock is a mesh), which takes a few percent of the carving time. For a scene
/// with a target, whose pitch depends on the walls, eight times as many.
std::size_t wall_samples(const Scene& scene, const Program& program);

/// Searches the swept shapes of a program, and a mesh stock, for walls and grooves thinner than the
/// pitch, without carving.
class WallCheck {
 public:
  /// Samples the surface with about `candidates` points. The scene and the program must outlive
  /// this object. The effort is limited by the number of motions, because a program may cut a point
  /// any number of times. The report has the spacing reached.
  WallCheck(const Scene& scene, const Program& program, std::size_t candidates,
            const std::stop_token& stop = {});

  /// Finds the walls and grooves thinner than the pitch of the scene's settings and thicker than
  /// the tolerance.
  WallReport find(const std::stop_token& stop = {}) const;
  /// Chooses the accuracy of a scene with a target again, with the pitch for its walls and sharp
  /// edges. On an error, one clause, the target will be missed there, or may be because the search
  /// reached its effort limit. Except in the last case the scene is then unchanged.
  std::expected<void, std::string> refine(Scene& scene, const std::stop_token& stop = {}) const;
  /// Returns the requirement of the scene's target, which it must have, at its pitch.
  WallTargetResult target_at_walls(const std::stop_token& stop = {}) const;
  /// Returns the description of a wall or groove: "p.ngc:5: a wall of 0.14 mm at X1 Y2 Z3, cut from
  /// the other side in line 8".
  std::string place_text(const ThinWall& wall) const;
  /// Returns one line for the walls and one for the grooves, if there are any: their number, and
  /// the thinnest missing one, or else the thinnest, with its position and the pitch that it needs.
  std::vector<std::string> warnings(const WallReport& report) const;
  /// Returns the JSON object of the report, with the warnings and the 100 thinnest.
  std::string json(const WallReport& report) const;

 private:
  const Scene& scene_;
  const Program& program_;
  std::size_t effort_;  ///< of each search
  TrueSolid solid_;
  CutSurface surface_;

  std::string warning(const WallReport& report, bool grooves) const;
  CutSurface sample(std::size_t candidates, const std::stop_token& stop) const;
};

}  // namespace kerf
