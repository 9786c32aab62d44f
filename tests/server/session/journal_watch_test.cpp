// SPDX-License-Identifier: Apache-2.0
// Journals damaged in parts that nobody reads.
#include "server/session/journal_watch.h"

#include "server/maintenance.h"
#include "server/session/journal_check.h"
#include "server/store/journal_file.h"
#include "server/store/journal_scan.h"
#include "tests/server/damage_fixture.h"

namespace kerf::journal_watch_test {
namespace {

using Clock = std::chrono::steady_clock;

class JournalWatchTest : public DamageTest {
 protected:
  /// Verifies in parts of one byte, i.e. one row each.
  WatchOptions small_parts() {
    return {.part_bytes = 1, .again = std::chrono::hours(1), .now = [this] { return time; }};
  }
  /// Runs a watch for `turns` turns.
  void run(int turns) {
    for (int n = 0; n < turns; ++n) watcher.run_delayed();
  }

  Clock::time_point time{};
  test::ManualExecutor watcher;
};

TEST_F(JournalWatchTest, DamageBeforeASnapshotIsReportedOnce) {
  leave();
  damage_record(journal(), strokes[0] + 3);
  reload();
  ASSERT_TRUE(registry->create("other", kScene, SceneSource{}));
  EXPECT_EQ(session->solid().hash(), hash) << "the snapshot spares the damaged records";
  JournalWatch watch(*registry, watcher, small_parts());
  watch.start();
  run(500);
  ASSERT_EQ(damages.size(), 1U);
  EXPECT_EQ(damages[0].find("block: " + journal().string() + ": record " +
                            std::to_string(strokes[0] + 3) + ": "),
            0U)
      << damages[0];
  const auto ready = ask("GET", "/readyz");
  EXPECT_EQ(ready.status, 200U);
  EXPECT_EQ(body(ready)["status"], "ready");
  EXPECT_EQ(body(ready)["damaged"], nlohmann::json::array({"block"}));
  EXPECT_NE(metrics.text(*registry).find("\nkerf_journal_damaged_sessions 1\n"), std::string::npos);
  const auto info = body(ask("GET", "/v1/sessions/block"))["damaged"];
  EXPECT_EQ(info["file"], "block.kerf");
  EXPECT_EQ(info["record"], strokes[0] + 3);
  EXPECT_NE(info["reason"].get<std::string>().find("kerf-server salvage"), std::string::npos);
  EXPECT_TRUE(body(ask("GET", "/v1/sessions/other"))["damaged"].is_null());
}

TEST_F(JournalWatchTest, IntactJournalIsVerifiedPeriodically) {
  leave();
  reload();
  JournalWatch watch(*registry, watcher, small_parts());
  watch.start();
  run(500);
  EXPECT_TRUE(damages.empty());
  damage_record(journal(), strokes[0]);
  run(500);
  EXPECT_TRUE(damages.empty()) << "the next pass is not due";
  time += std::chrono::hours(2);
  run(500);
  EXPECT_EQ(damages.size(), 1U);
}

TEST_F(JournalWatchTest, TemporaryReadFailureIsNotDamage) {
  leave();
  damage_record(journal(), strokes[1] + 15);
  reload();
  JournalWatch watch(*registry, watcher, small_parts());
  watch.start();
  run(10);
  const auto aside = folder / "aside";
  std::filesystem::rename(journal(), aside);
  run(500);
  EXPECT_TRUE(damages.empty());
  std::filesystem::rename(aside, journal());
  run(500);
  EXPECT_TRUE(damages.empty()) << "it is tried again after a minute";
  time += std::chrono::minutes(2);
  run(500);
  EXPECT_EQ(damages.size(), 1U);
}

TEST_F(JournalWatchTest, WorkHasPausesAndEndsWithTheServer) {
  leave();
  damage_record(journal(), strokes[1] + 15);
  reload();
  WatchOptions slow = small_parts();
  slow.now = [this] { return time += std::chrono::milliseconds(5); };
  JournalWatch watch(*registry, watcher, slow);
  watch.start();
  run(10);
  EXPECT_GE(watcher.last_delay, slow.pause_factor * std::chrono::milliseconds(5));
  watch.stop();
  run(500);
  EXPECT_TRUE(damages.empty());
}

TEST_F(JournalWatchTest, ScanFindsAnyDamagedRecordAndReportsAStop) {
  leave();
  ASSERT_TRUE(scan_journal(journal()));
  std::stop_source stop;
  stop.request_stop();
  const auto stopped = scan_journal(journal(), stop.get_token());
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, JournalErrorCode::kIo);
  const auto copy = folder / "copy.kerf";
  for (std::uint64_t record = 1; record <= last; record += 7) {
    std::filesystem::copy_file(journal(), copy, std::filesystem::copy_options::overwrite_existing);
    damage_record(copy, record);
    JournalScan scan(copy);
    const auto found = scan.finish();
    ASSERT_FALSE(found) << record;
    EXPECT_EQ(found.error().code, JournalErrorCode::kCorrupt);
    EXPECT_EQ(found.error().sequence, scan.verified() + 1);
    EXPECT_LE(found.error().sequence, record);
  }
}

TEST_F(JournalWatchTest, RequestsForADamagedRecordNameIt) {
  leave();
  damage_record(journal(), strokes[0] + 3);
  const std::string at = "?at=" + std::to_string(strokes[2]);
  const std::pair<const char*, std::string> requests[] = {
      {"GET", "/strokes"},
      {"POST", "/undo?strokes=" + std::to_string(strokes[3])},
      {"GET", "/program.ngc"},
      {"GET", "/program.apt"},
      {"GET", "/forces.csv"},
      {"GET", "/forces"},
      {"GET", "/model.stl" + at},
      {"GET", "/replay" + at},
      {"GET", "/probe?at_mm=0,-12,-2&normal=0,0,1"}};
  for (const auto& [method, target] : requests) {
    SCOPED_TRACE(target);
    reload();
    const auto answer = ask(method, "/v1/sessions/block" + target);
    EXPECT_EQ(answer.status, 500U);
    const auto error = body(answer)["error"];
    EXPECT_EQ(error["code"], "damaged_journal");
    const auto reason = error["reason"].get<std::string>();
    EXPECT_NE(reason.find("record " + std::to_string(strokes[0] + 3)), std::string::npos) << reason;
    EXPECT_NE(reason.find("kerf-server salvage"), std::string::npos) << reason;
    EXPECT_EQ(reason.find(folder.path().string()), std::string::npos) << reason;
    EXPECT_EQ(damages.size(), 1U) << "the watch need not have come so far";
  }
  SerialWorkers alone;
  const auto undone =
      session->stroke_changes().change({.strokes = {strokes[3]}, .caller = Caller::local()}, alone);
  ASSERT_FALSE(undone);
  EXPECT_EQ(undone.error().code, wire::ErrorCode::kDamagedJournal);
}

TEST_F(JournalWatchTest, ABackupNamesADamagedSessionAndCopiesAll) {
  leave();
  std::filesystem::copy_file(journal(), folder / "zebra.kerf");
  damage_record(journal(), strokes[0] + 3);
  const auto to = folder / "backup";
  testing::internal::CaptureStderr();
  EXPECT_EQ(back_up(folder.path(), to), 1);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find(journal().string() + " is damaged, and was copied as it is"),
            std::string::npos)
      << said;
  EXPECT_EQ(said.find("zebra"), std::string::npos) << said;
  EXPECT_TRUE(scan_journal(to / "zebra.kerf"));
  EXPECT_FALSE(scan_journal(to / "block.kerf"));
  EXPECT_TRUE(std::filesystem::exists(to / "block.kerf-snapshot"));
}

TEST_F(JournalWatchTest, ABackupCopiesAJournalWithDamagedPages) {
  leave();
  std::filesystem::copy_file(journal(), folder / "zebra.kerf");
  std::fstream file(journal(), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(4096);
  file << std::string(4096, 'x');
  file.close();
  const auto to = folder / "backup";
  EXPECT_EQ(back_up(folder.path(), to), 1);
  EXPECT_EQ(std::filesystem::file_size(to / "block.kerf"), std::filesystem::file_size(journal()));
  EXPECT_TRUE(scan_journal(to / "zebra.kerf"));
}

/// Returns the permission bits of a file for everyone but its owner.
std::filesystem::perms for_others(const std::filesystem::path& file) {
  using enum std::filesystem::perms;
  return std::filesystem::status(file).permissions() & (group_all | others_all);
}

TEST_F(JournalWatchTest, FilesOfASessionArePrivate) {
  leave();
  reload();
  const auto joined = session->join({ParticipantKind::kAgent, "Bob", "", 1, true});
  stroke(joined->id, 8);
  ASSERT_TRUE(copy_journal(journal(), folder / "copy.kerf"));
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    if (!entry.is_regular_file()) continue;
    if (!entry.path().filename().string().contains(".kerf")) continue;
    EXPECT_EQ(for_others(entry.path()), std::filesystem::perms::none) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 5) << "the journal, its log and index, the snapshots and the copy";
  session.reset();
  ASSERT_TRUE(registry->close("block", false));
  EXPECT_EQ(for_others(registry->closed_folder()), std::filesystem::perms::none);
}

}  // namespace
}  // namespace kerf::journal_watch_test
