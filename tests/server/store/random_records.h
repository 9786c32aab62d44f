// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/formats/pose_grid.h"
#include "server/store/record_batch.h"
#include "tests/support/test.h"

namespace kerf::test {

/// A pose on the pose grid.
inline ToolPose pose_of(double x_mm, double y_mm, double z_mm, Vec3 axis = {0, 0, 1}) {
  return admit_pose({{x_mm, y_mm, z_mm}, axis});
}

/// Records as in a session: several hands, programs, tools and random numbers.
inline std::vector<BatchRecord> random_records(std::mt19937_64& random, std::size_t count) {
  std::map<ParticipantId, ToolPose> at;
  std::vector<BatchRecord> records;
  const auto real = [&](double most) {
    return std::uniform_real_distribution<double>(-most, most)(random);
  };
  while (records.size() < count) {
    const auto participant = static_cast<ParticipantId>(1 + random() % 4);
    if (random() % 50 == 0) {
      const double radius = 1 + static_cast<double>(random() % 9);
      records.push_back({0, DefineTool{3, make_tool({BallPiece{radius, radius}}, {}).value()}});
      continue;
    }
    MoveTool move;
    move.tool = static_cast<ToolId>(1 + random() % 20 / 19);
    move.from = random() % 30 == 0 ? pose_of(real(50), real(50), real(50)) : at[participant];
    const double step = random() % 40 == 0 ? 1e5 : 0.1;
    move.to = pose_of(move.from.tip_mm.x + real(step), move.from.tip_mm.y + 0.1, real(1),
                      random() % 2 == 0 ? move.from.axis : Vec3{real(1), real(1), real(1) + 1e-3});
    if (random() % 60 == 0) move.to.tip_mm.x += 1e-10;  // not on the grid
    move.duration_s = static_cast<double>(random() % 3000) * 1e-6;
    if (random() % 60 == 0) move.duration_s = real(1);
    move.feel = random() % 10 != 0;
    at[participant] = move.to;
    records.push_back({participant, move, random() % 20 == 0});
  }
  return records;
}

}  // namespace kerf::test
