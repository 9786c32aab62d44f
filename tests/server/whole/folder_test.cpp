// SPDX-License-Identifier: Apache-2.0
// The data folder of a server: damaged journals and limits of the disk.
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "server/log/log.h"
#include "server/store/sqlite.h"
#include "tests/server/whole/hand.h"
#include "tests/server/whole/whole_server.h"

namespace kerf::test::folder_test {
namespace {

class DataFolder : public WholeServer {
 protected:
  static void change(const std::filesystem::path& file, const std::string& statement) {
    auto database = SqlDatabase::open(file, SqlMode::kWrite);
    ASSERT_TRUE(database && database->execute(statement)) << statement;
  }
  void carve(int steps, const std::string& session = "block") const {
    Hand(port, session).carve(steps);
  }
  /// Restarts the server. Returns the log of the start.
  std::string log_of_a_restart() {
    server.reset();
    testing::internal::CaptureStderr();
    log::open();
    start();
    server.reset();
    const std::string text = testing::internal::GetCapturedStderr();
    log::open();
    start();
    return text;
  }
  Json ready(unsigned status) {
    const Answer answer = ask("GET", "/readyz");
    EXPECT_EQ(answer.status, status) << answer.body;
    return answer.json();
  }
  bool is_paused(const std::string& session = "block") {
    return eventually([&] { return info(session).at("paused") == "disk"; });
  }
};

TEST_F(DataFolder, DamagedJournalsDoNotAffectOtherSessions) {
  carve(200);
  create("other");
  const std::string expected = hash();
  wait_for_the_journal();
  server.reset();
  for (const char* name : {"flipped", "foreign", "truncated"}) {
    std::filesystem::copy_file(journal(), journal(name));
  }
  change(journal("flipped"),
         "UPDATE batches SET bytes = zeroblob(7) WHERE first = (SELECT max(first) FROM batches)");
  change(journal("foreign"), "PRAGMA user_version = 99");
  std::filesystem::resize_file(journal("truncated"), 9000);
  std::ofstream(journal("text")) << std::string(1000, 't');
  start();
  const Json listed = made("GET", "/v1/sessions");
  ASSERT_EQ(listed.at("sessions").size(), 2U);
  EXPECT_EQ(listed.at("sessions").at(0).at("id"), "block");
  EXPECT_EQ(listed.at("sessions").at(1).at("id"), "other");
  EXPECT_EQ(listed.at("unreadable").size(), 4U);
  EXPECT_EQ(hash(), expected);
  const std::string log = log_of_a_restart();
  for (const char* words : {"flipped.kerf: record ", ": the checksum of the records is wrong",
                            "foreign_journal_version", "truncated.kerf", "not_a_journal"}) {
    EXPECT_TRUE(log.contains(words)) << words << "\n" << log;
  }
  EXPECT_EQ(error("GET", "/v1/sessions/flipped"), "500 unreadable_session");
  EXPECT_EQ(error("POST", "/v1/sessions?id=flipped", kBlock.dump()), "409 session_exists");
}

TEST_F(DataFolder, JournalOfAnotherKernelIsRecarvedAndLogged) {
  carve(200);
  const std::string expected = hash();
  wait_for_the_journal();
  EXPECT_FALSE(log_of_a_restart().contains("carved again"));
  server.reset();
  change(journal(), "UPDATE kernel_versions SET version=1");
  change(journal(), "UPDATE state_hashes SET hash=2989");
  const std::string log = log_of_a_restart();
  EXPECT_TRUE(
      log.contains("session block: the journal is of kernel version 1; carved again with version"))
      << log;
  EXPECT_EQ(hash(), expected);
  EXPECT_FALSE(log_of_a_restart().contains("carved again")) << "it is one of this version now";
  server.reset();
  change(journal(), "UPDATE state_hashes SET hash=2989");
  EXPECT_TRUE(log_of_a_restart().contains("replay gives state hash"));
}

TEST_F(DataFolder, HashBeyondTheLastRecordIsDroppedAndLogged) {
  carve(50);
  const std::string expected = hash();
  wait_for_the_journal();
  server.reset();
  change(journal(), "INSERT INTO state_hashes VALUES(9999, 2989)");
  EXPECT_TRUE(log_of_a_restart().contains("session block: the journal ends after record"));
  EXPECT_EQ(hash(), expected);
  EXPECT_FALSE(log_of_a_restart().contains("the journal ends after"));
}

TEST_F(DataFolder, SessionAtItsLimitIsPausedAndClosedOnesReopen) {
  carve(200);
  wait_for_the_journal();
  const std::string expected = hash();
  server.reset();
  // Without SQLite's log, whose size depends on the number of commits.
  options.disk.session = std::filesystem::file_size(journal()) / 2;
  start();
  EXPECT_TRUE(is_paused());
  // The server stays ready when one session reaches its own limit.
  EXPECT_EQ(ready(200).at("status"), "ready");
  EXPECT_EQ(ready(200).at("paused"), Json({"block"}));
  create("second");
  carve(20, "second");
  made("DELETE", "/v1/sessions/block");
  const Json closed = made("GET", "/v1/closed").at("closed");
  ASSERT_EQ(closed.size(), 1U);
  EXPECT_EQ(closed.at(0).at("id"), "block");
  const std::string one = "/v1/closed/" + closed.at(0).at("name").get<std::string>();
  options.disk = {.folder = 1000};
  restart();
  EXPECT_TRUE(is_paused("second"));
  EXPECT_EQ(ready(503).at("status"), "paused");
  const Answer full = ask("POST", "/v1/sessions?id=third", kBlock.dump());
  EXPECT_EQ(full.status, 507U);
  EXPECT_EQ(full.code(), "disk_full");
  EXPECT_TRUE(full.body.contains("--disk-total"));
  options.disk = {};
  restart();
  EXPECT_EQ(made("POST", one),
            Json({{"id", "block"}, {"url", "/v1/sessions/block"}, {"recarved", false}}));
  EXPECT_EQ(hash(), expected);
  EXPECT_EQ(ask("POST", one).status, 404U);
  EXPECT_EQ(ask("DELETE", "/v1/closed/..%2Fblock").status, 404U);
  carve(20);
}

TEST_F(DataFolder, DownloadsEndBeforeSessionsArePaused) {
  carve(20);
  options.disk.reserve = std::filesystem::space(data()).available / 10 * 7;
  restart();
  const std::string model = "/v1/sessions/block/model.stl";
  EXPECT_TRUE(eventually([&] { return ask("GET", model).status == 507; }));
  const Answer refused = ask("GET", model);
  EXPECT_EQ(refused.code(), "disk_full");
  EXPECT_TRUE(refused.body.contains("--disk-reserve")) << refused.body;
  carve(20);
  EXPECT_TRUE(info().at("paused").is_null());
  ready(200);
}

}  // namespace
}  // namespace kerf::test::folder_test
