// SPDX-License-Identifier: Apache-2.0
// Sessions that are opened while the server already answers.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "server/http/api.h"
#include "tests/server/session_fixture.h"

namespace kerf::net::session_loading_test {
namespace {

class SessionLoading : public SessionTest {
 protected:
  /// Leaves closed journals of some carved sessions, and a registry that has found them.
  void leave_sessions(const std::vector<std::string>& ids) {
    for (const std::string& id : ids) {
      const auto session = *registry->create(id, kScene, SceneSource{});
      const auto ada = join(*session);
      sequence = 0;
      carve_circle(*session, ada, 50 + static_cast<int>(hashes.size()));
      hashes[id] = session->solid().hash();
      ASSERT_TRUE(session->flush());
    }
    restart();
    options.data_folder = folder.path();
    api.emplace(options, *registry, metrics, *access);
    ASSERT_TRUE(registry->find_journals());
  }
  ApiResponse ask(const std::string& method, std::string_view target) {
    ApiRequest request = *parse_target(target);
    request.method = method;
    request.body = kScene;
    return api->handle(request);
  }
  static nlohmann::json body(const ApiResponse& response) {
    return nlohmann::json::parse(response.body);
  }

  std::map<std::string, std::uint64_t> hashes;
  HttpOptions options;
  Metrics metrics;
  std::unique_ptr<Access> access = *Access::open({});
  std::optional<Api> api;
};

/// A cluster that has lost server b, which alone has session s.
class LostServer final : public SessionPlaces {
 public:
  std::expected<void, std::string> claim(const std::string&, bool) override { return {}; }
  bool is_taken(const std::string& id) const override { return id == "s"; }
  std::shared_ptr<const WriteFence> fence(const std::string&) const override { return nullptr; }
  std::uint32_t epoch(const std::string&) const override { return 1; }
  std::expected<void, std::string> close(const std::string&) override { return {}; }
  void give_up(const std::string&) override {}
  const std::string& node() const override { return node_; }
  std::vector<PlacedSession> elsewhere() const override { return {}; }
  std::optional<std::string> address_of(const std::string&) const override { return {}; }
  bool is_moving(const std::string&) const override { return false; }
  std::optional<std::string> needed_server(const std::string& id) const override {
    return id == "s" ? std::optional<std::string>("b") : std::nullopt;
  }
  std::vector<std::string> other_servers() const override { return {}; }
  std::optional<std::string> place_for_new() override { return {}; }
  bool wants_to_follow(const std::string&) override { return false; }

 private:
  std::string node_ = "a";
};

TEST_F(SessionLoading, ASessionThatOnlyALostServerHasIsA503WithItsName) {
  LostServer places;
  registry.emplace(
      RegistryOptions{.data_folder = folder.path(), .places = &places},
      [this](const std::string&) { return executor; }, workers);
  api.emplace(options, *registry, metrics, *access);
  const ApiResponse asked = ask("GET", "/v1/sessions/s");
  EXPECT_EQ(asked.status, 503U);
  EXPECT_EQ(body(asked)["error"]["code"], "server_lost");
  EXPECT_THAT(std::string(body(asked)["error"]["reason"]), testing::HasSubstr("server b "));
  EXPECT_EQ(ask("GET", "/v1/sessions/t").status, 404U);
  api.reset();
  registry.reset();
}

TEST_F(SessionLoading, RequestsForALoadingSessionGetARetryTime) {
  leave_sessions({"a", "b"});
  const ApiResponse asked = ask("GET", "/v1/sessions/b");
  EXPECT_EQ(asked.status, 503U);
  EXPECT_EQ(body(asked)["error"]["code"], "session_loading");
  EXPECT_EQ(asked.headers.at(0), std::pair(std::string("Retry-After"), std::string("1")));
  EXPECT_EQ(ask("DELETE", "/v1/sessions/b").status, 503U);
  EXPECT_EQ(ask("GET", "/v1/sessions/c").status, 404U);
  EXPECT_EQ(body(ask("POST", "/v1/sessions?id=b"))["error"]["code"], "session_exists");
  EXPECT_EQ(ask("GET", "/healthz").status, 200U);
  const ApiResponse ready = ask("GET", "/readyz");
  EXPECT_EQ(ready.status, 503U);
  EXPECT_EQ(body(ready)["status"], "loading");
  EXPECT_EQ(body(ready)["loading"], nlohmann::json::array({"a", "b"}));
  EXPECT_EQ(body(ask("GET", "/v1/sessions"))["loading"], nlohmann::json::array({"a", "b"}));
  EXPECT_TRUE(metrics.text(*registry).contains("\nkerf_sessions_loading 2\n"));
  EXPECT_EQ(registry->ids(), (std::vector<std::string>{"a", "b"}));

  LoadReport report;
  EXPECT_TRUE(registry->load_next(report));
  EXPECT_EQ(body(ask("GET", "/readyz"))["loading"], nlohmann::json::array({"b"}));
  EXPECT_TRUE(registry->load_next(report));
  EXPECT_FALSE(registry->load_next(report));
  EXPECT_EQ(ask("GET", "/readyz").status, 200U);
  EXPECT_EQ(body(ask("GET", "/v1/sessions"))["sessions"].size(), 2U);
  for (const auto& [id, hash] : hashes) EXPECT_EQ(registry->find(id)->current_hash()->hash, hash);
}

TEST_F(SessionLoading, LoadingSessionsCount) {
  leave_sessions({"a", "b", "c", "d"});
  EXPECT_EQ(body(ask("POST", "/v1/sessions?id=e"))["error"]["code"], "too_many_sessions");
  LoadReport report;
  while (registry->load_next(report)) {
  }
  EXPECT_EQ(report.loaded.size(), 4U);
  EXPECT_EQ(body(ask("POST", "/v1/sessions?id=e"))["error"]["code"], "too_many_sessions");
}

TEST_F(SessionLoading, StrangersSeeOnlyNumbersOfSessions) {
  leave_sessions({"a", "b"});
  access = *Access::open({.admin_token = std::string(40, 'x')});
  api.emplace(options, *registry, metrics, *access);
  const auto ready = body(ask("GET", "/readyz"));
  EXPECT_EQ(ready["status"], "loading");
  EXPECT_EQ(ready["loading"], 2);
  EXPECT_EQ(ready["paused"], 0);
  EXPECT_EQ(ready["unreadable"], 0);
}

TEST_F(SessionLoading, RequestedSessionIsLoadedNext) {
  leave_sessions({"a", "b", "c"});
  registry->hasten("c");
  registry->hasten("unknown");
  LoadReport report;
  EXPECT_TRUE(registry->load_next(report));
  EXPECT_TRUE(registry->find("c"));
  EXPECT_FALSE(registry->find("a"));
}

TEST_F(SessionLoading, SessionsLoadInParallelDespiteABrokenJournal) {
  std::ofstream(folder / "broken.kerf") << std::string(5000, 'x');
  leave_sessions({"a", "b", "c", "d"});
  std::vector<LoadReport> reports(3);
  {
    std::vector<std::jthread> threads;
    for (LoadReport& report : reports) {
      threads.emplace_back([this, &report] {
        while (registry->load_next(report)) {
        }
      });
    }
  }
  std::size_t loaded = 0, failed = 0;
  for (const LoadReport& report : reports) {
    loaded += report.loaded.size();
    failed += report.failures.size();
  }
  EXPECT_EQ(loaded, 4U);
  EXPECT_EQ(failed, 1U);
  EXPECT_TRUE(registry->loaded());
  EXPECT_TRUE(registry->unreadable("broken"));
  for (const auto& [id, hash] : hashes) EXPECT_EQ(registry->find(id)->current_hash()->hash, hash);
}

TEST_F(SessionLoading, OnlyDiskFailuresAreRetried) {
  leave_sessions({"a"});
  int tries = 0;
  const auto load_with = [&](std::function<void()> fail) {
    tries = 0;
    registry.emplace(
        RegistryOptions{folder.path(), 4, limits},
        [this, &tries, fail](const std::string&) {
          ++tries;
          if (tries < 3) fail();
          return executor;
        },
        workers);
    return registry->load_all();
  };
  const LoadReport memory = load_with([] { throw std::bad_alloc(); });
  ASSERT_EQ(memory.failures.size(), 1U);
  EXPECT_EQ(memory.failures[0].code, JournalErrorCode::kNotLoaded);
  EXPECT_EQ(ask("GET", "/readyz").status, 200U);  // it will not change by itself
  EXPECT_TRUE(registry->retry_disk_failures().empty());
  EXPECT_EQ(tries, 1);

  const LoadReport system = load_with(
      [] { throw std::system_error(std::make_error_code(std::errc::no_space_on_device)); });
  ASSERT_EQ(system.failures.size(), 1U);
  EXPECT_EQ(system.failures[0].code, JournalErrorCode::kIo);
  EXPECT_TRUE(registry->retry_disk_failures().empty());
  EXPECT_EQ(ask("GET", "/readyz").status, 503U);
  EXPECT_EQ(body(ask("GET", "/readyz"))["status"], "paused");
  EXPECT_EQ(registry->retry_disk_failures(), std::vector<std::string>{"a"});
  EXPECT_EQ(ask("GET", "/readyz").status, 200U);
  EXPECT_EQ(tries, 3);
}

TEST_F(SessionLoading, StoppingServerLoadsNothingMore) {
  leave_sessions({"a", "b"});
  LoadReport report;
  registry->stop_loading();
  EXPECT_FALSE(registry->load_next(report));
  EXPECT_TRUE(registry->loading().empty());
  // A peer that waited for a session returns, and does not assume that it is gone.
  const ApiResponse waited = ask("GET", "/v1/sessions/b");
  EXPECT_EQ(waited.status, 503U);
  EXPECT_EQ(body(waited)["error"]["code"], "stopping");
  EXPECT_EQ(waited.headers.at(0), std::pair(std::string("Retry-After"), std::string("1")));
  // A session that is being replayed fails soon.
  std::stop_source stop;
  stop.request_stop();
  const auto replayed = replay(folder / "a.kerf", stop.get_token());
  ASSERT_FALSE(replayed);
  EXPECT_EQ(replayed.error().code, JournalErrorCode::kIo);
}

}  // namespace
}  // namespace kerf::net::session_loading_test
