// SPDX-License-Identifier: Apache-2.0
// Updates of agents' replicas after undo.
#include "tests/server/undo_fixture.h"

namespace kerf::undo_replica_test {
namespace {

using UndoReplica = SessionUndo;

TEST_F(UndoReplica, ReplicasRestartWhereStockReturned) {
  create();
  const ParticipantId ada = join("Ada", true), bo = join("Bo", true);
  const StrokeId a = stroke(ada, {-5, 0, -2}, {5, 0, -2});
  move(bo, {-15, -15, 2}, false);
  move(ada, {5, 0, 5}, false);
  move(ada, {5, 0, 1}, false);
  for (const ParticipantId id : {ada, bo}) {
    while (const auto patch = session_->replicas().update(id)) {
      ASSERT_TRUE(session_->replicas().ack(id, patch->sequence));
    }
  }
  undo({a});
  const auto update = session_->replicas().update(ada);
  ASSERT_TRUE(update);
  EXPECT_TRUE(update->reset);
}

TEST_F(UndoReplica, ReplicasLearnThatTheMotionOutOfStockIsUncut) {
  create();
  const ParticipantId ada = join("Ada", true), bo = join("Bo");
  stroke(bo, {10, -15, -3}, {10, 15, -3});
  move(ada, {-10, 0, 1}, false);
  move(ada, {-10, 0, -1});
  const StrokeId first = session_->sequence();
  for (int n = 0; n < 10; ++n) move(ada, {-10.0 + n, 0, -1});
  undo({first});
  ASSERT_EQ(move(ada, {0, 0, -1}).rejections.size(), 1U);
  while (const auto update = session_->replicas().update(ada)) {
    ASSERT_TRUE(session_->replicas().ack(ada, update->sequence));
  }
  const std::uint64_t records = session_->sequence();
  time_ms_ += 20;
  EXPECT_TRUE(move(ada, {10, 0, -1}).rejections.empty());  // into Bo's groove
  EXPECT_EQ(session_->sequence(), records);
  const auto update = session_->replicas().update(ada);
  ASSERT_TRUE(update);
  EXPECT_TRUE(update->reset);
}

}  // namespace
}  // namespace kerf::undo_replica_test
