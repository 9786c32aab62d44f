// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/replica/replica.h"
#include "tests/support/test.h"

namespace kerf::agent {

inline constexpr const char* kWelcome = R"({
  "stock": {"shape": "box", "min_mm": [-30, -30, -20], "max_mm": [30, 30, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 6, "length_mm": 30}],
  "force": {"law": "specific_energy", "specific_force_n_per_mm2": 0.4, "pivot_mm": 40}})";
inline constexpr Vec3 kUp{0, 0, 1};
inline constexpr std::uint32_t kOther = 7;
/// The other agent's clock is behind, and its poses are this many samples late.
inline constexpr std::uint64_t kBehindUs = 123'456'789;
inline constexpr int kLate = 100;
inline constexpr int kEvery = 10;

inline std::uint64_t time_of(int n) { return 200'000'000 + 1000 * static_cast<std::uint64_t>(n); }

inline wire::Intent intent_of(int n, Vec3 tip_mm, bool cuts = true) {
  return wire::Intent{.participant = kOther,
                      .tool_id = 1,
                      .time_us = time_of(n) - kBehindUs,
                      .agent_time_us = time_of(n),
                      .tip_mm = tip_mm,
                      .status = cuts ? wire::kStatusCutting : 0};
}

inline wire::StockPatch all_tiles() {
  wire::StockPatch all{.reset = true};
  for (std::uint32_t y = 0; y < 4; ++y) {
    for (std::uint32_t x = 0; x < 4; ++x) all.tiles.push_back({2, x, y, {}});
  }
  return all;
}

/// The agent's replica, which has all tiles, and the block as cut by the server.
struct Side {
  Side() : source(*BlockSource::read(kWelcome)), truth(source.make()), replica(source) {
    EXPECT_TRUE(replica.take(all_tiles()));
  }
  /// Cuts with both tools, the other one first. Returns the force on the agent's tool in the true
  /// block.
  Vec3 cut(Vec3 own, Vec3 other) {
    Vec3 force_n;
    if (last.count > 0) {
      truth.apply(MoveTool{1, {last.other, kUp}, {other, kUp}, 0.001, false}).value();
      force_n =
          truth.apply(MoveTool{1, {last.own, kUp}, {own, kUp}, 0.001, true}).value().wrench.force_n;
    }
    last = {own, other, last.count + 1};
    return force_n;
  }
  Vec3 felt(int n, Vec3 own, bool cuts = true) {
    wire::MotionSample sample{.agent_sequence = static_cast<std::uint64_t>(n + 1),
                              .time_us = time_of(n),
                              .tip_mm = own,
                              .tool_id = 1,
                              .buttons = cuts ? wire::kButtonCutting : 0};
    const auto answer = replica.move(sample);
    return answer ? Vec3(answer->force_n) : Vec3{};
  }
  struct Last {
    Vec3 own, other;
    int count = 0;
  };
  BlockSource source;
  Sculpture truth;
  Replica replica;
  Last last;
};

}  // namespace kerf::agent
