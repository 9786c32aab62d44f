// SPDX-License-Identifier: Apache-2.0
#include "server/session/disk_limits.h"

#include <fstream>

#include "server/session/replay.h"
#include "server/store/block_snapshot.h"
#include "tests/server/session_fixture.h"

namespace kerf::disk_limits_test {
namespace {

void write_file(const std::filesystem::path& file, std::size_t bytes) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << std::string(bytes, 'x');
}

TEST(DiskLimits, MeasuresAllFilesOfFolderAndSession) {
  const test::TemporaryFolder folder;
  write_file(folder / "a.kerf", 1000);
  write_file(folder / "a.kerf-wal", 200);
  write_file(snapshot_file(folder / "a.kerf"), 30);
  write_file(previous_snapshot_file(folder / "a.kerf"), 7);
  write_file(folder / "closed" / "b-1700000000.kerf", 4);
  EXPECT_EQ(measure_disk(folder.path()).folder, 1241U);
  EXPECT_GT(measure_disk(folder.path()).free, 0U);
  EXPECT_EQ(session_bytes(folder / "a.kerf"), 1237U);
  EXPECT_EQ(measure_disk(folder / "missing").folder, 0U);
}

TEST(DiskLimits, FullLevelPersistsUntilFine) {
  using enum DiskLevel;
  EXPECT_EQ(disk_level(0, kFine), kFine);
  EXPECT_EQ(disk_level(0.89, kLow), kFine);
  EXPECT_EQ(disk_level(0.91, kFine), kLow);
  EXPECT_EQ(disk_level(1, kFine), kFull);
  EXPECT_EQ(disk_level(0.91, kFull), kFull);
  EXPECT_EQ(disk_level(0.89, kFull), kFine);
}

TEST(DiskLimits, GreaterShareCountsAndZeroMeansNoLimit) {
  EXPECT_EQ(shared_share({1000, 0}, {}), 0);
  EXPECT_EQ(shared_share({50, 1000}, {.folder = 100, .reserve = 100}), 0.5);
  EXPECT_EQ(shared_share({50, 125}, {.folder = 100, .reserve = 100}), 0.8);
  EXPECT_GE(shared_share({50, 0}, {.folder = 100, .reserve = 100}), 1);
}

TEST(DiskLimits, DownloadsLeaveTwiceTheReserve) {
  EXPECT_EQ(needed_for_sessions({0, 200}, {.reserve = 100}), std::nullopt);
  const auto needed = needed_for_sessions({0, 199'000'000}, {.reserve = 100'000'000});
  ASSERT_TRUE(needed);
  EXPECT_NE(needed->find("199.0 MB left"), std::string::npos) << *needed;
  EXPECT_NE(needed->find("200.0 MB"), std::string::npos) << *needed;
  EXPECT_EQ(needed_for_sessions({0, 0}, {}), std::nullopt) << "without a reserve";
}

class SessionDisk : public SessionTest {
 protected:
  void limit(const DiskLimits& limits_of_disk) {
    registry.emplace(
        RegistryOptions{folder.path(), 4, limits,
                        [this](const auto&, const auto& error) {
                          reports.push_back(error ? to_string(error->code) : "continues");
                        },
                        snapshots, limits_of_disk},
        [this](const std::string&) { return executor; }, workers);
    registry->load_all();
  }
  void fill(std::size_t bytes) { write_file(folder / "ballast", bytes); }

  test::ManualExecutor writer;
  std::vector<std::string> reports;
};

TEST_F(SessionDisk, SessionPausesAtItsLimitAndCommitsAcceptedRecords) {
  auto session = start();
  carve_circle(*session, join(*session));
  ASSERT_TRUE(session->flush());
  const std::uint64_t hash = session->solid().hash();
  const std::uintmax_t bytes = session->disk_bytes();
  session.reset();
  registry.reset();
  executor->run();
  limit({.session = bytes / 2});
  session = registry->find("block");
  ASSERT_TRUE(session);
  const auto id = join(*session);
  move(*session, id, 0, 0, -5);
  EXPECT_TRUE(move(*session, id, 0.1, 0, -5).rejections.empty());
  registry->keep_disk_limits();
  const auto refused = move(*session, id, 0.2, 0, -5);
  ASSERT_EQ(refused.rejections.size(), 1U);
  EXPECT_EQ(refused.rejections[0].code, wire::ErrorCode::kBusy);
  EXPECT_TRUE(refused.rejections[0].reason.contains("--disk-per-session"))
      << refused.rejections[0].reason;
  EXPECT_EQ(session->info().paused, "disk");
  ASSERT_TRUE(session->flush());
  EXPECT_EQ(reports, (std::vector<std::string>{"session_limit"}));
  const auto replayed = replay(session->journal_file());
  ASSERT_TRUE(replayed);
  EXPECT_EQ(replayed->hash.hash, session->solid().hash());
  EXPECT_NE(replayed->hash.hash, hash);
}

TEST_F(SessionDisk, AgentResumesInASessionPausedByALimit) {
  limit({.session = 1});
  const auto session = start();
  JoinRequest request{.kind = ParticipantKind::kAgent, .name = "Ada", .color = "", .durable = true};
  const auto ada = session->admit(request);
  ASSERT_TRUE(ada);
  carve_circle(*session, ada->participant.id);
  ASSERT_TRUE(session->flush());
  registry->keep_disk_limits();
  ASSERT_TRUE(session->pause());
  request.token = ada->token;
  const auto resumed = session->admit(request);
  ASSERT_TRUE(resumed) << resumed.error().reason;
  EXPECT_TRUE(resumed->resumed);
}

TEST_F(SessionDisk, SharedLimitIsNamedEvenAtASessionsOwnLimit) {
  limit({.session = 1, .folder = 1'000'000});
  const auto session = start();
  registry->keep_disk_limits();
  EXPECT_EQ(session->pause()->code, JournalErrorCode::kSessionLimit);
  fill(1'000'000);
  registry->keep_disk_limits();
  EXPECT_EQ(session->pause()->code, JournalErrorCode::kDiskLimit);
  fill(0);
  registry->keep_disk_limits();
  EXPECT_EQ(session->pause()->code, JournalErrorCode::kSessionLimit);
}

TEST_F(SessionDisk, FullFolderPausesAllSessionsAndRejectsNewOnes) {
  limit({.folder = 1'000'000});
  const auto session = start();
  const auto id = join(*session);
  carve_circle(*session, id);
  fill(1'000'000);
  registry->keep_disk_limits();
  EXPECT_FALSE(move(*session, id, 9.9, 0, -4).rejections.empty());
  const auto refused = registry->create("second", kScene, SceneSource{});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, RegistryErrorCode::kDiskFull);
  EXPECT_TRUE(refused.error().reason.contains("--disk-total")) << refused.error().reason;
  fill(100'000);
  registry->keep_disk_limits();
  EXPECT_EQ(session->info().paused, "");
  EXPECT_TRUE(move(*session, id, 9.8, 0, -4).rejections.empty());
  EXPECT_TRUE(registry->create("second", kScene, SceneSource{}));
  EXPECT_EQ(reports, (std::vector<std::string>{"disk_limit", "continues"}));
}

TEST_F(SessionDisk, ReserveStaysFree) {
  limit({.reserve = ~std::uintmax_t{0} / 2});
  const auto refused = registry->create("block", kScene, SceneSource{});
  ASSERT_FALSE(refused);
  EXPECT_TRUE(refused.error().reason.contains("--disk-reserve")) << refused.error().reason;
}

TEST_F(SessionDisk, NoSnapshotIsWrittenWhileTheDiskIsLow) {
  snapshots.writer = &writer;
  snapshots.limits = {.replay_time = {}, .age = std::chrono::hours(1), .pause = {}};
  limit({.folder = 10'000'000});  // so large that the journal is a small share
  const auto session = start();
  const auto id = join(*session);
  fill(9'000'000);
  registry->keep_disk_limits();
  carve_circle(*session, id);
  executor->run();
  writer.run();
  EXPECT_FALSE(std::filesystem::exists(snapshot_file(session->journal_file())));
  EXPECT_EQ(session->info().paused, "");
  fill(0);
  registry->keep_disk_limits();
  carve_circle(*session, id);
  executor->run();
  writer.run();
  EXPECT_TRUE(std::filesystem::exists(snapshot_file(session->journal_file())));
}

}  // namespace
}  // namespace kerf::disk_limits_test
