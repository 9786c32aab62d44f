// SPDX-License-Identifier: Apache-2.0
#include "server/carve/program_cutter.h"

#include <utility>

#include "kernel/cut/workers.h"
#include "server/carve/simulation.h"
#include "server/verify/cut_depth.h"

namespace kerf {
namespace {

/// Motions cut together: enough work for several threads, however short they are. Together they
/// reach at most about kTilesTogether tiles, half a second's work, because a stop waits for them.
constexpr std::size_t kMotionsTogether = 64;
constexpr std::int64_t kTilesTogether = 8192;
/// Distances computed between two looks at the stop token: a tenth of a second.
constexpr std::size_t kDistancesTogether = 100'000;

}  // namespace

ProgramCutter::ProgramCutter(const Scene& scene, const Program& program, Sculpture& sculpture,
                             Workers& workers, bool feel, const ConvexOutline* within)
    : scene_(scene),
      program_(program),
      sculpture_(sculpture),
      workers_(workers),
      feel_(feel),
      within_(within),
      air_(scene.settings) {}

std::expected<std::vector<ProgramCut>, std::string> ProgramCutter::cut(
    std::span<const ProgramMotion> motions, const std::stop_token& stop) {
  const ProgramMotion& first = motions.front();
  std::vector<ProgramCut> cuts;
  if (is_rapid_near_stock(first)) {
    if (auto ok = check(first); !ok) return std::unexpected(std::move(ok.error()));
    cuts.push_back(cut_alone(first, stop));
    return cuts;
  }
  std::vector<MoveTool> moves;
  std::int64_t tiles = 0;
  for (const ProgramMotion& motion : motions) {
    if (moves.size() == kMotionsTogether || tiles >= kTilesTogether) break;
    if (!moves.empty() && is_rapid_near_stock(motion)) break;
    if (auto ok = check(motion); !ok) return std::unexpected(std::move(ok.error()));
    moves.push_back(move_of(motion));
    tiles += sculpture_.tiles_in_reach(moves.back());
  }
  for (MotionResult& result : sculpture_.apply(moves, workers_))
    cuts.push_back({.result = std::move(result)});
  return cuts;
}

ProgramCut ProgramCutter::cut_alone(const ProgramMotion& motion, const std::stop_token& stop) {
  const DexelSnapshot before = sculpture_.snapshot();
  const MoveTool move = move_of(motion);
  MotionResult result = std::move(sculpture_.apply(std::span(&move, 1), workers_).front());
  const double depth_mm = depth_of(motion, before, result, stop);
  return {std::move(result), depth_mm};
}

std::expected<void, std::string> ProgramCutter::check(const ProgramMotion& motion) const {
  const auto ok = sculpture_.check(move_of(motion));
  if (ok) return {};
  return std::unexpected(place_of(program_, motion.file, motion.line) + ": " + ok.error().reason);
}

MoveTool ProgramCutter::move_of(const ProgramMotion& motion) const {
  return {.tool = motion.tool,
          .from = motion.from,
          .to = motion.to,
          .duration_s = motion.duration_s,
          .feel = feel_};
}

bool ProgramCutter::is_rapid_near_stock(const ProgramMotion& motion) const {
  return motion.rapid && !air_.is_clear(move_of(motion), scene_.tools.at(motion.tool).tool);
}

double ProgramCutter::depth_of(const ProgramMotion& motion, const DexelSnapshot& before,
                               const MotionResult& result, const std::stop_token& stop) {
  if (result.removed_mm3 <= kNothingRemovedMm3) return 0;
  CutDepth depth(scene_.tools.at(motion.tool).tool, motion.from, motion.to,
                 scene_.settings.tolerance_mm, before, sculpture_.snapshot(), result.cut_tiles,
                 within_);
  while (!stop.stop_requested() && !depth.advance(kDistancesTogether)) {
  }
  return depth.depth_mm();
}

}  // namespace kerf
