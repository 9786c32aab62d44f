// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "server/http/api.h"
#include "server/matters.h"
#include "server/session/session_registry.h"
#include "server/store/block_snapshot.h"
#include "server/store/sqlite.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf {

/// Flips a bit in the middle of a journal's row that contains a record.
inline void damage_record(const std::filesystem::path& journal, std::uint64_t record) {
  auto database = SqlDatabase::open(journal, SqlMode::kWrite);
  ASSERT_TRUE(database);
  auto rows =
      database->prepare("SELECT first, bytes FROM batches WHERE first<=? AND first+count>?");
  rows->bind(1, static_cast<std::int64_t>(record));
  rows->bind(2, static_cast<std::int64_t>(record));
  ASSERT_TRUE(*rows->step());
  const auto blob = rows->blob(1);
  std::vector<std::byte> bytes(blob.begin(), blob.end());
  bytes[bytes.size() / 2] ^= std::byte{4};
  auto update = database->prepare("UPDATE batches SET bytes=? WHERE first=?");
  update->bind(1, std::span<const std::byte>(bytes));
  update->bind(2, rows->integer(0));
  ASSERT_TRUE(*rows->step() == false && update->step());
}

/// The session "block" with strokes. A snapshot has the first of them, so a restarted server only
/// reads the records after it.
class DamageTest : public testing::Test {
 protected:
  /// Runs work at once on the posting thread, and never runs delayed work.
  class AtOnce final : public Executor {
   public:
    void post(Work work) override { work(); }
    void post_after(std::chrono::microseconds, Work) override {}
  };

  void SetUp() override { restart(); }
  void restart() {
    api.reset();
    session.reset();
    registry.reset();
    writer = {};
    damages.clear();
    options.data_folder = folder.path();
    RegistryOptions registry_options{.data_folder = folder.path(),
                                     .sessions_max = 4,
                                     .snapshots = {.writer = &writer},
                                     .matters = net::matters()};
    registry_options.snapshots.limits = {
        .replay_time = {}, .age = std::chrono::hours(1), .pause = {}};
    registry_options.on_damage = [this](const std::string& id, const JournalError& damage) {
      damages.push_back(id + ": " + describe(damage));
    };
    registry.emplace(
        registry_options, [](const std::string&) { return std::make_shared<AtOnce>(); }, workers);
    api.emplace(options, *registry, metrics, *access, net::http_matters());
  }
  /// Restarts and loads the session, which must succeed.
  Session& reload() {
    restart();
    for (const JournalError& failure : registry->load_all().failures) {
      ADD_FAILURE() << describe(failure);
    }
    session = registry->find("block");
    return *session;
  }
  /// Cuts along X, with a row of the journal for each motion. Returns the number of the stroke.
  std::uint64_t stroke(ParticipantId id, double y_mm, int motions = 20) {
    const auto send = [&](double x_mm, double z_mm, bool cuts) {
      wire::MotionSample sample{.agent_sequence = ++samples,
                                .time_us = 1000 * samples,
                                .tip_mm = {x_mm, y_mm, z_mm},
                                .tool_id = 1,
                                .buttons = cuts ? wire::kButtonCutting : 0};
      EXPECT_TRUE(session->move(id, {&sample, 1}).rejections.empty());
      EXPECT_TRUE(session->flush());
    };
    send(-10, 5, false);
    send(-10, -2, false);
    const std::uint64_t first = session->sequence() + 1;
    for (int n = 1; n <= motions; ++n) send(-10 + n, -2 - 0.05 * n, true);
    send(-10 + motions, 5, false);
    return first;
  }
  ParticipantId join() {
    const auto joined = session->join({ParticipantKind::kAgent, "Ada", "", 1, true});
    EXPECT_TRUE(joined);
    return joined->id;
  }
  /// Leaves a closed journal of four strokes. Its snapshot has the first two, after which the
  /// server was restarted: batches from there on can be read without their predecessors.
  void leave(bool with_snapshot = true) {
    session = *registry->create("block", kScene, SceneSource{});
    ParticipantId id = join();
    strokes = {stroke(id, -12), stroke(id, -4)};
    writer.run();
    stroke(id, 0, 1);
    writer.run();
    registry->close_all("the server stops");  // with a last snapshot
    reload();
    id = join();
    strokes.push_back(stroke(id, 4));
    strokes.push_back(stroke(id, 12));
    session->note_hash({session->sequence(), session->solid().hash()});
    hash = session->solid().hash();
    last = session->sequence();
    ASSERT_TRUE(session->flush());
    restart();
    if (!with_snapshot) remove_snapshots();
  }
  void remove_snapshots() const {
    std::filesystem::remove(snapshot_file(journal()));
    std::filesystem::remove(previous_snapshot_file(journal()));
  }
  std::filesystem::path journal() const { return folder / "block.kerf"; }
  net::ApiResponse ask(const std::string& method, std::string_view target) {
    net::ApiRequest request = *net::parse_target(target);
    request.method = method;
    return api->handle(request);
  }
  static nlohmann::json body(const net::ApiResponse& response) {
    return nlohmann::json::parse(response.body);
  }

  test::TemporaryFolder folder;
  test::ManualExecutor writer, workers;
  net::HttpOptions options;
  net::Metrics metrics;
  std::unique_ptr<Access> access = *Access::open({});
  std::vector<std::string> damages;  ///< all reported damages
  std::optional<SessionRegistry> registry;
  std::optional<net::Api> api;
  std::shared_ptr<Session> session;
  std::vector<std::uint64_t> strokes;
  std::uint64_t samples = 0, hash = 0, last = 0;
};

}  // namespace kerf
