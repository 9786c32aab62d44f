// SPDX-License-Identifier: Apache-2.0
// Sessions that are closed while the disk fails.
#include "server/session/replay.h"
#include "tests/server/damage_fixture.h"
#include "tests/server/store/faulty_disk.h"

namespace kerf::session_closing_test {
namespace {

using test::DiskFault;
using test::FaultTarget;

class SessionClosing : public DamageTest {
 protected:
  void TearDown() override {  // closes the journals before the disk goes
    api.reset();
    session.reset();
    registry.reset();
  }
  test::FaultyDisk disk;
};

TEST_F(SessionClosing, FullDiskKeepsTheSessionOpen) {
  session = *registry->create("block", kScene, SceneSource{});
  const auto id = session->join({ParticipantKind::kAgent, "Ada", "", 1, true})->id;
  stroke(id, 0);
  for (const DiskFault fault : {DiskFault::kNoSpace, DiskFault::kSyncFails}) {
    disk.fail({fault, FaultTarget::kAll, 0});
    wire::MotionSample sample{.agent_sequence = ++samples,
                              .time_us = 1000 * samples,
                              .tip_mm = {10, 0, -3},
                              .tool_id = 1};
    session->move(id, {&sample, 1});
    sample.tip_mm.x -= 1;
    sample.agent_sequence = ++samples;
    sample.time_us = 1000 * samples;
    sample.buttons = wire::kButtonCutting;
    session->move(id, {&sample, 1});  // accepted but not on the disk
    const std::uint64_t solid = session->solid().hash(), records = session->sequence();
    const auto refused = ask("DELETE", "/v1/sessions/block");
    EXPECT_EQ(refused.status, 507U) << refused.body;
    EXPECT_EQ(body(refused)["error"]["code"], "not_closed");
    const auto direct = registry->close("block", false);
    ASSERT_FALSE(direct);
    EXPECT_EQ(direct.error().code, RegistryErrorCode::kNotClosed);
    EXPECT_EQ(registry->find("block"), session);
    EXPECT_FALSE(session->closed());
    EXPECT_EQ(session->info().participants.size(), 1U) << "nobody was sent away";
    disk.heal();
    ASSERT_TRUE(session->flush());
    EXPECT_EQ(session->solid().hash(), solid);
    EXPECT_EQ(session->committed(), records);
    const auto replayed = replay(journal());
    ASSERT_TRUE(replayed);
    EXPECT_EQ(replayed->hash.hash, solid);
    stroke(id, 1);
  }
  session.reset();
  const auto closed = ask("DELETE", "/v1/sessions/block");
  EXPECT_EQ(closed.status, 200U) << closed.body;
  EXPECT_FALSE(registry->find("block"));
  EXPECT_EQ(registry->closed().size(), 1U);
}

TEST_F(SessionClosing, SessionReopensIfItsJournalCannotBeMoved) {
  session = *registry->create("block", kScene, SceneSource{});
  stroke(session->join({ParticipantKind::kAgent, "Ada", "", 1, true})->id, 0);
  const std::uint64_t solid = session->solid().hash();
  std::ofstream(registry->closed_folder()) << "a file of this name";
  const auto refused = registry->close("block", false);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, RegistryErrorCode::kNotClosed);
  ASSERT_TRUE(registry->find("block"));
  EXPECT_EQ(registry->find("block")->solid().hash(), solid);
}

TEST_F(SessionClosing, ADeletedSessionNeedsNoDisk) {
  session = *registry->create("block", kScene, SceneSource{});
  stroke(session->join({ParticipantKind::kAgent, "Ada", "", 1, true})->id, 0);
  session.reset();
  disk.fail({DiskFault::kNoSpace, FaultTarget::kAll, 0});
  EXPECT_TRUE(registry->close("block", true));
  EXPECT_FALSE(std::filesystem::exists(journal()));
}

}  // namespace
}  // namespace kerf::session_closing_test
