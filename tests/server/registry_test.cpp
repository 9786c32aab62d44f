// SPDX-License-Identifier: Apache-2.0
#include <barrier>
#include <expected>
#include <filesystem>
#include <fstream>
#include <set>
#include <stop_token>
#include <string>
#include <thread>

#include "server/session/replay.h"
#include "tests/server/session_fixture.h"

namespace kerf::registry_test {
namespace {

/// Runs work at once on the posting thread, and never runs delayed work.
class ImmediateExecutor final : public Executor {
 public:
  void post(Work work) override { work(); }
  void post_after(std::chrono::microseconds, Work) override {}
};

TEST_F(SessionTest, LongSceneNamesAreRejected) {
  const auto named = [](std::size_t bytes) {
    std::string scene = kScene;
    return scene.replace(scene.find("Test block"), 10, std::string(bytes, 'n'));
  };
  for (const std::string id : {"", "block"}) {
    const auto long_one = registry->create(id, named(900'000), SceneSource{});
    ASSERT_FALSE(long_one);
    EXPECT_EQ(long_one.error().code, RegistryErrorCode::kBadScene);
    EXPECT_EQ(long_one.error().path, "name");
    EXPECT_TRUE(long_one.error().reason.contains("has 900000 bytes; at most 200"))
        << long_one.error().reason;
    EXPECT_FALSE(registry->check(id, named(201), SceneSource{}));
  }
  EXPECT_TRUE(registry->create("block", named(200), SceneSource{}));
}

TEST_F(SessionTest, StoppedCreationLeavesNothing) {
  std::stop_source stop;
  stop.request_stop();
  SceneSource source;
  source.stop = stop.get_token();
  const auto created = registry->create("block", kScene, source);
  ASSERT_FALSE(created);
  EXPECT_EQ(created.error().code, RegistryErrorCode::kStopped);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  const auto session = start();
  const auto branched = registry->branch("copy", *session, session->sequence(), stop.get_token());
  ASSERT_FALSE(branched);
  EXPECT_EQ(branched.error().code, RegistryErrorCode::kStopped);
  EXPECT_FALSE(std::filesystem::exists(registry->journal_path("copy")));
  EXPECT_TRUE(registry->branch("copy", *session, session->sequence()));
}

TEST_F(SessionTest, KeptJournalsOfOneNameDoNotOverwriteEachOther) {
  registry.emplace(
      RegistryOptions{folder.path(), 4, limits},
      [](const std::string&) { return std::make_shared<ImmediateExecutor>(); }, workers);
  std::set<std::uint64_t> sequences;
  for (int n = 0; n < 5; ++n) {
    const auto session = start();
    sequence = 0;
    carve_circle(*session, join(*session), 200 + n);
    sequences.insert(session->sequence());
    EXPECT_TRUE(registry->close("block", false));
  }
  std::set<std::uint64_t> kept;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "closed")) {
    const auto replayed = replay(entry.path());
    ASSERT_TRUE(replayed) << describe(replayed.error());
    kept.insert(replayed->last_sequence);
  }
  EXPECT_EQ(kept, sequences);
}

class ClosedSessions : public SessionTest {
 protected:
  void SetUp() override {
    registry.emplace(
        RegistryOptions{folder.path(), 4, limits},
        [](const std::string&) { return std::make_shared<ImmediateExecutor>(); }, workers);
  }
  std::uint64_t leave_closed() {
    const auto session = start();
    sequence = 0;
    carve_circle(*session, join(*session));
    const std::uint64_t hash = session->solid().hash();
    EXPECT_TRUE(registry->close("block", false));
    return hash;
  }
};

TEST_F(ClosedSessions, AreListedAndReopenedToTheBit) {
  const std::uint64_t hash = leave_closed();
  const auto closed = registry->closed();
  ASSERT_EQ(closed.size(), 1U);
  EXPECT_EQ(closed[0].id, "block");
  EXPECT_GT(closed[0].closed_s, 1'700'000'000);
  EXPECT_GT(closed[0].bytes, 1000U);
  EXPECT_FALSE(registry->find("block"));
  LoadReport report;
  const auto reopened = registry->reopen(closed[0].name, report);
  ASSERT_TRUE(reopened) << reopened.error().reason;
  EXPECT_EQ(registry->find("block"), *reopened);
  EXPECT_EQ((*reopened)->solid().hash(), hash);
  EXPECT_TRUE(registry->closed().empty());
}

TEST_F(ClosedSessions, StayClosedIfTheyCannotBeReopened) {
  leave_closed();
  leave_closed();
  auto closed = registry->closed();
  ASSERT_EQ(closed.size(), 2U);
  EXPECT_EQ(closed[1].id, "block");  // same id despite the distinguishing name
  const auto open = start();
  LoadReport report;
  const auto taken = registry->reopen(closed[0].name, report);
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code, RegistryErrorCode::kExists);
  EXPECT_TRUE(registry->close("block", true));
  std::ofstream(folder / "closed" / (closed[0].name + ".kerf")) << "broken";
  EXPECT_FALSE(registry->reopen(closed[0].name, report));
  EXPECT_EQ(registry->closed().size(), 2U);
  EXPECT_TRUE(registry->unreadable().empty());
  EXPECT_TRUE(registry->reopen(closed[1].name, report));
}

TEST_F(ClosedSessions, AreFoundByListedNamesOnly) {
  leave_closed();
  start();
  LoadReport report;
  for (const char* name : {"block", "../block", "", ".", "closed/block"}) {
    EXPECT_FALSE(registry->reopen(name, report)) << name;
    const auto deleted = registry->delete_closed(name);
    ASSERT_FALSE(deleted) << name;
    EXPECT_EQ(deleted.error().code, RegistryErrorCode::kUnknown);
  }
  EXPECT_TRUE(registry->find("block"));
  const auto closed = registry->closed();
  EXPECT_TRUE(registry->delete_closed(closed[0].name));
  EXPECT_TRUE(registry->closed().empty());
  EXPECT_TRUE(std::filesystem::is_empty(folder / "closed"));
}

TEST_F(ClosedSessions, AreEitherDeletedOrReopened) {
  for (int round = 0; round < 8; ++round) {
    leave_closed();
    const std::string name = registry->closed().at(0).name;
    std::barrier start_line(2);
    std::expected<void, RegistryError> deleted;
    std::jthread deleting([&] {
      start_line.arrive_and_wait();
      deleted = registry->delete_closed(name);
    });
    LoadReport report;
    start_line.arrive_and_wait();
    const auto reopened = registry->reopen(name, report);
    deleting.join();
    ASSERT_NE(deleted.has_value(), reopened.has_value()) << "round " << round;
    const RegistryError& late = deleted ? reopened.error() : deleted.error();
    EXPECT_EQ(late.code, RegistryErrorCode::kUnknown) << late.reason;
    if (reopened) {
      EXPECT_TRUE(std::filesystem::exists(folder / "block.kerf"));
      EXPECT_TRUE(registry->close("block", true));
    }
    EXPECT_TRUE(registry->closed().empty());
  }
}

}  // namespace
}  // namespace kerf::registry_test
