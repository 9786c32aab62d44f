// SPDX-License-Identifier: Apache-2.0
// The door of a matter in the HTTP interface: its routes, its store, and who answers.
#include <string>
#include <string_view>
#include <vector>

#include "server/downloads/download_routes.h"
#include "server/http/responses.h"
#include "server/http/routes.h"
#include "server/people/people_routes.h"
#include "server/pictures/picture_routes.h"
#include "server/probe/probe_routes.h"
#include "server/programs/program_routes.h"
#include "server/strokes/stroke_routes.h"
#include "server/targets/target_routes.h"
#include "tests/server/api_rights_fixture.h"

namespace kerf::net::matters_test {
namespace {

/// The store of a matter that the server does not know. It records its calls.
class Counts final : public MatterStore {
 public:
  explicit Counts(std::vector<std::string>& calls) : calls_(calls) {}
  int next() { return ++count_; }
  void attach_all(Session& session) override { calls_.push_back("attach " + session.id()); }
  void forget(const std::string& session) override { calls_.push_back("forget " + session); }
  void free_memory() override { calls_.emplace_back("free"); }
  void stop() override { calls_.emplace_back("stop"); }

 private:
  std::vector<std::string>& calls_;
  int count_ = 0;
};

std::vector<std::string> calls;

constexpr Route kRoutes[] = {{
    .methods = "POST",
    .pattern = "/v1/sessions/{id}/count",
    .answer =
        [](const ApiCall& call) {
          auto& counts = call.services.stores.get<Counts>();
          return json_response(200, std::to_string(counts.next()));
        },
    .action = Action::kWatch,
}};

HttpMatter counts() {
  return {.routes = kRoutes, .make_store = [](ApiServices&) -> std::unique_ptr<MatterStore> {
            return std::make_unique<Counts>(calls);
          }};
}

class MattersTest : public ApiRightsTest {
 protected:
  void SetUp() override {
    ApiRightsTest::SetUp();
    const HttpMatter matter = counts();
    api.reset();
    api.emplace(options, *registry, metrics, *access, std::span(&matter, 1));
    calls.clear();
  }
};

TEST_F(MattersTest, AnInterfaceServesTheRoutesOfAMatterFromItsStore) {
  EXPECT_EQ(ask("POST", "/v1/sessions/block/count", kAdmin).body, "1\n");
  EXPECT_EQ(ask("POST", "/v1/sessions/block/count", kAdmin).body, "2\n");
  EXPECT_EQ(ask("GET", "/v1/sessions/block/count", kAdmin).status, 405U);
  EXPECT_EQ(ask("POST", "/v1/sessions/block/count", "").status, 401U);
  EXPECT_EQ(ask("GET", "/v1/sessions/block/pins", kAdmin).status, 404U) << "not registered";
}

TEST_F(MattersTest, AStoreLearnsOfTheBeginningAndEndOfASession) {
  ASSERT_TRUE(registry->create("other", kScene, SceneSource{}));
  EXPECT_EQ(calls, (std::vector<std::string>{"forget other", "attach other"}));
  calls.clear();
  ASSERT_EQ(ask("DELETE", "/v1/sessions/other", kAdmin).status, 200U);
  EXPECT_EQ(calls, std::vector<std::string>{"forget other"});
  calls.clear();
  api->stop();
  EXPECT_EQ(calls, std::vector<std::string>{"stop"});
}

TEST_F(MattersTest, StoresFreeMemoryBeforeARequestIsRejected) {
  options.program_bytes = 1000;
  const HttpMatter matter = counts();
  ApiServices services(options, *registry, *access, std::span(&matter, 1));
  const auto first = take_memory(services, 900);
  EXPECT_TRUE(first);
  EXPECT_TRUE(calls.empty());
  EXPECT_FALSE(take_memory(services, 200));
  EXPECT_EQ(calls, std::vector<std::string>{"free"});
}

struct Served {
  HttpMatter matter;
  std::string_view method, target;
  bool is_at_owner = false;  ///< no server that follows the session answers
};

TEST(Matters, EachServesItsRoutesAloneHereOrAtTheOwner) {
  const Served all[] = {
      {http_downloads(), "GET", "/v1/sessions/b/model.stl"},
      {http_downloads(), "GET", "/v1/sessions/b/program.ngc"},
      {http_downloads(), "GET", "/v1/sessions/b/exports", true},
      {http_people(), "GET", "/v1/sessions/b/authors"},
      {http_people(), "GET", "/v1/sessions/b/regions", true},
      {http_people(), "POST", "/v1/sessions/b/invitations", true},
      {http_pictures(), "GET", "/v1/sessions/b/picture.png"},
      {http_probe(), "POST", "/v1/sessions/b/owners"},
      {http_programs(), "GET", "/v1/sessions/b/programs", true},
      {http_programs(), "GET", "/v1/sessions/b/programs/1/path", true},
      {http_strokes(), "GET", "/v1/sessions/b/strokes"},
      {http_strokes(), "POST", "/v1/sessions/b/undo", true},
      {http_targets(), "GET", "/v1/sessions/b/targets", true},
      {http_targets(), "GET", "/v1/sessions/b/targets/t.stl/deviation", true},
  };
  for (const Served& served : all) {
    const RouteTable table(std::span(&served.matter, 1));
    const RouteMatch match = table.match(served.method, parse_target(served.target)->path);
    ASSERT_NE(match.route, nullptr) << served.target;
    EXPECT_NE(match.route->answer, nullptr) << served.target;
    EXPECT_EQ(only_looks(match), !served.is_at_owner) << served.target;
  }
}

}  // namespace
}  // namespace kerf::net::matters_test
