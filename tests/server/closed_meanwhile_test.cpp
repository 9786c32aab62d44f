// SPDX-License-Identifier: Apache-2.0
// Requests whose session is deleted, and its id reused, while they are handled.
#include "server/store/journal_file.h"
#include "tests/server/api_rights_fixture.h"
#include "tests/support/test.h"

namespace kerf::net::closed_meanwhile_test {
namespace {

/// Runs work at once, and runs `before` ahead of the first work after it was set.
class InterruptedExecutor final : public Executor {
 public:
  void post(Work work) override {
    if (before) std::exchange(before, nullptr)();
    work();
  }
  void post_after(std::chrono::microseconds, Work) override {}
  std::function<void()> before;
};

class ClosedMeanwhile : public testing::Test {
 protected:
  void SetUp() override {
    options_.data_folder = folder_.path();
    registry_.emplace(
        RegistryOptions{.data_folder = folder_.path(), .sessions_max = 4, .matters = matters()},
        [this](const std::string&) { return executor_; }, workers_);
    access_ = *Access::open({});
    api_.emplace(options_, *registry_, metrics_, *access_, http_matters());
    ASSERT_TRUE(registry_->create("block", kScene, SceneSource{}));
  }
  ApiResponse ask(const std::string& method, std::string_view target) {
    ApiRequest request = *parse_target(target);
    request.method = method;
    return api_->handle(request);
  }
  static std::string code(const ApiResponse& response) {
    return Json::parse(response.body).at("error").at("code");
  }
  void purge() { EXPECT_EQ(ask("DELETE", "/v1/sessions/block?purge=1").status, 200U); }
  /// Writes the file of a journal in creation: a database without tables.
  void begin_journal() {
    auto database = test::value_of(SqlDatabase::open(folder_ / "block.kerf", SqlMode::kCreate));
    EXPECT_TRUE(database.execute("PRAGMA journal_mode=WAL"));
  }

  test::TemporaryFolder folder_;
  HttpOptions options_;
  Metrics metrics_;
  std::shared_ptr<InterruptedExecutor> executor_ = std::make_shared<InterruptedExecutor>();
  EagerExecutor workers_;
  std::optional<SessionRegistry> registry_;
  std::unique_ptr<Access> access_;
  std::optional<Api> api_;
};

TEST_F(ClosedMeanwhile, JournalCreatedUnderTheSameIdIsNotAnError) {
  executor_->before = [&] {
    purge();
    begin_journal();
  };
  const ApiResponse response = ask("GET", "/v1/sessions/block/replay");
  EXPECT_EQ(response.status, 404U) << response.body;
  EXPECT_EQ(code(response), "unknown_session");
}

TEST_F(ClosedMeanwhile, NothingIsReadFromTheJournalOfTheNextSession) {
  const auto created = [&] {
    const ApiResponse replay = ask("GET", "/v1/sessions/block/replay");
    return Json::parse(replay.body).at("journal").get<std::string>();
  };
  const std::string first = created();
  executor_->before = [&] {
    purge();
    ASSERT_TRUE(registry_->create("block", kScene, SceneSource{}));
  };
  const ApiResponse response = ask("GET", "/v1/sessions/block/replay");
  EXPECT_EQ(response.status, 404U) << response.body;
  EXPECT_EQ(code(response), "unknown_session");
  EXPECT_NE(created(), first);
}

TEST_F(ClosedMeanwhile, ChangeThatFailsWithItsSessionIsNotAServerError) {
  executor_->before = [&] {
    purge();
    begin_journal();
  };
  const ApiResponse response = ask("POST", "/v1/sessions/block/versions?name=mine&at=1");
  EXPECT_EQ(response.status, 404U) << response.body;
  EXPECT_EQ(code(response), "unknown_session");
}

}  // namespace
}  // namespace kerf::net::closed_meanwhile_test
