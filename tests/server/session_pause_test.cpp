// SPDX-License-Identifier: Apache-2.0
// Sessions whose disk fails, and journals that cannot be read.
#include <fstream>
#include <nlohmann/json.hpp>

#include "server/http/api.h"
#include "server/session/replay.h"
#include "tests/server/session_fixture.h"
#include "tests/server/store/faulty_disk.h"

namespace kerf::net::session_pause_test {
namespace {

using test::DiskFault;
using test::FaultTarget;

class SessionPause : public SessionTest {
 protected:
  void SetUp() override {
    SessionTest::SetUp();
    options.data_folder = folder.path();
    api.emplace(options, *registry, metrics, *access);
  }
  void TearDown() override { registry.reset(); }  // closes the journals before the disk goes
  ApiResponse get(std::string_view target) {
    ApiRequest request = *parse_target(target);
    request.method = "GET";
    return api->handle(request);
  }
  static nlohmann::json body(const ApiResponse& response) {
    return nlohmann::json::parse(response.body);
  }
  bool has_metric(const std::string& line) {
    return metrics.text(*registry).find("\n" + line + "\n") != std::string::npos;
  }

  test::FaultyDisk disk;
  HttpOptions options;
  Metrics metrics;
  std::unique_ptr<Access> access = *Access::open({});
  std::optional<Api> api;
};

TEST_F(SessionPause, MotionsAreRejectedWhileTheDiskIsFullAndNothingAcceptedIsLost) {
  registry->load_all();
  const auto session = start();
  const auto id = join(*session);
  carve_circle(*session, id);
  EXPECT_EQ(get("/readyz").status, 200U);
  disk.fail({DiskFault::kNoSpace, FaultTarget::kAll, 0});
  // On a slow machine all motions before it may already be committed.
  move(*session, id, 10 * std::cos(6.4), 10 * std::sin(6.4), -3.1);
  EXPECT_FALSE(session->flush());
  move(*session, id, 0, 0, -5);  // too fast: the next motion starts there
  const auto refused = move(*session, id, 0.1, 0, -5);
  ASSERT_EQ(refused.rejections.size(), 1U);
  EXPECT_EQ(refused.rejections[0].code, wire::ErrorCode::kBusy);
  EXPECT_TRUE(refused.rejections[0].reason.contains("paused: disk: "));
  EXPECT_EQ(session->info().paused, "disk");
  EXPECT_EQ(session->frame(false).paused, "disk");
  EXPECT_EQ(get("/readyz").status, 503U);
  EXPECT_EQ(body(get("/readyz"))["status"], "paused");
  EXPECT_EQ(body(get("/readyz"))["paused"], nlohmann::json::array({"block"}));
  EXPECT_TRUE(has_metric("kerf_journal_paused{session=\"block\"} 1"));
  EXPECT_FALSE(has_metric("kerf_journal_failed_commits{session=\"block\"} 0"));
  const std::uint64_t hash = session->solid().hash();
  session->note_hash({session->sequence(), hash});

  disk.heal();
  ASSERT_TRUE(session->flush());
  EXPECT_EQ(session->info().paused, "");
  EXPECT_EQ(get("/readyz").status, 200U);
  EXPECT_TRUE(has_metric("kerf_journal_paused{session=\"block\"} 0"));
  const auto replayed = replay(session->journal_file());
  ASSERT_TRUE(replayed) << describe(replayed.error());
  EXPECT_EQ(replayed->hash.hash, hash);
  EXPECT_EQ(replayed->sculpture.motions(), session->info().motions);
  EXPECT_TRUE(move(*session, id, 0.2, 0, -5).rejections.empty());
}

TEST_F(SessionPause, AgentsResumeOnlyWhileTheJournalAcceptsSamples) {
  registry->load_all();
  const auto session = start();
  JoinRequest request{.kind = ParticipantKind::kAgent, .name = "Ada", .color = "", .durable = true};
  const auto ada = session->admit(request);
  ASSERT_TRUE(ada);
  carve_circle(*session, ada->participant.id);
  request.token = ada->token;
  disk.fail({DiskFault::kNoSpace, FaultTarget::kAll, 0});
  EXPECT_FALSE(session->flush());
  const auto refused = session->admit(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, wire::ErrorCode::kBusy);
  EXPECT_TRUE(refused.error().reason.contains("paused: disk: "));
  EXPECT_EQ(session->info().participants.size(), 1U);
  disk.heal();
  ASSERT_TRUE(session->flush());
  const auto resumed = session->admit(request);
  ASSERT_TRUE(resumed);
  EXPECT_TRUE(resumed->resumed);
}

TEST_F(SessionPause, PausesAreReportedWithTheSession) {
  std::vector<std::string> reports;
  registry.emplace(
      RegistryOptions{folder.path(), 4, limits,
                      [&](const std::string& id, const std::optional<JournalError>& error) {
                        reports.push_back(id + (error ? " pauses" : " continues"));
                      }},
      [this](const std::string&) { return executor; }, workers);
  const auto session = start();
  const auto id = join(*session);
  disk.fail({DiskFault::kSyncFails, FaultTarget::kAll, 0});
  move(*session, id, 0, 0, -1);
  move(*session, id, 1, 0, -1);
  EXPECT_FALSE(session->flush());
  EXPECT_FALSE(session->flush());
  disk.heal();
  EXPECT_TRUE(session->flush());
  EXPECT_TRUE(session->finish_journal());
  EXPECT_EQ(reports, (std::vector<std::string>{"block pauses", "block continues"}));
}

TEST_F(SessionPause, AJournalWithAHashBeyondItsEndIsLoadedAndNamed) {
  std::uint64_t sequence_then = 0;
  {
    const auto session = start();
    carve_circle(*session, join(*session));
    sequence_then = session->sequence();
    session->note_hash({sequence_then + 50, 0xBAD});
    ASSERT_TRUE(session->flush());
  }
  for (const std::size_t shortened : {1U, 0U}) {
    restart();
    const LoadReport report = registry->load_all();
    ASSERT_TRUE(report.failures.empty()) << describe(report.failures[0]);
    ASSERT_EQ(report.shortened.size(), shortened);
    if (shortened > 0) {
      EXPECT_EQ(report.shortened[0].id, "block");
      EXPECT_EQ(report.shortened[0].last_sequence, sequence_then);
    }
    // Later records reach the sequence of the dropped hash.
    const auto session = registry->find("block");
    sequence = 0;
    carve_circle(*session, join(*session));
    EXPECT_GT(session->sequence(), sequence_then + 50);
    ASSERT_TRUE(session->flush());
  }
}

TEST_F(SessionPause, AnUnreadableJournalIsListedAndItsIdStaysTaken) {
  ASSERT_TRUE(registry->create("good", kScene, SceneSource{}));
  std::ofstream(folder / "block.kerf") << std::string(5000, 'x');
  restart();
  api.emplace(options, *registry, metrics, *access);
  EXPECT_EQ(get("/readyz").status, 503U);
  EXPECT_EQ(body(get("/readyz"))["status"], "loading");
  EXPECT_EQ(registry->load_all().failures.size(), 1U);
  EXPECT_EQ(get("/readyz").status, 200U);
  EXPECT_EQ(body(get("/readyz"))["unreadable"], nlohmann::json::array({"block"}));
  ASSERT_TRUE(registry->unreadable("block"));
  EXPECT_FALSE(registry->unreadable("good"));
  const ApiResponse asked = get("/v1/sessions/block");
  EXPECT_EQ(asked.status, 500U);
  EXPECT_EQ(body(asked)["error"]["code"], "unreadable_session");
  const auto created = registry->create("block", kScene, SceneSource{});
  ASSERT_FALSE(created);
  EXPECT_EQ(created.error().code, RegistryErrorCode::kExists);
  EXPECT_EQ(std::filesystem::file_size(folder / "block.kerf"), 5000U);
  // The operator moves the file away.
  std::filesystem::remove(folder / "block.kerf");
  EXPECT_TRUE(registry->create("block", kScene, SceneSource{}));
  EXPECT_FALSE(registry->unreadable("block"));
}

}  // namespace
}  // namespace kerf::net::session_pause_test
