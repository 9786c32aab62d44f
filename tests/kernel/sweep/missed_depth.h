// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <random>

#include "kernel/tool/tool.h"
#include "kernel/tool/tool_pose.h"

namespace kerf::test {

inline constexpr int kMissGenes = 23;
inline constexpr int kMissTools = 10;

/// A motion of a tool near 8 x 8 rays, as numbers in [0, 1] that a search may vary.
struct MissCase {
  int tool;       ///< kind of the tool, below kMissTools
  double top_mm;  ///< of the grid
  std::array<double, kMissGenes> genes;
};

/// Returns the depth, in units of the tolerance, of the deepest point of the rays that the moving
/// tool reaches but its sweep leaves, below zero if there is none. Brute force over the shares of
/// the motion, which shares no code with the sweep. Every `stride`th ray is judged.
double missed_depth(const MissCase& c, int stride = 1);

/// Searches for cases with a large missed depth: the worst of a few random cases is varied as long
/// as that makes it worse.
class MissSearch {
 public:
  explicit MissSearch(std::uint64_t seed) : random_(seed) {}
  /// Returns the worst case of one climb from random cases, and its depth.
  MissCase climb(double& depth);
  /// As climb, from cases that differ little from `c`.
  MissCase climb_near(const MissCase& c, double& depth);

 private:
  template <class Start>
  MissCase climb_from(const Start& start, double& depth);
  double share() { return static_cast<double>(random_()) / 18446744073709551616.0; }
  MissCase any_case();
  MissCase near(MissCase c);
  MissCase varied(MissCase c);

  std::mt19937_64 random_;
};

}  // namespace kerf::test
