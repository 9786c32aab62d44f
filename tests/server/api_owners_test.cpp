// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstring>
#include <limits>
#include <vector>

#include "tests/server/api_rights_fixture.h"

namespace kerf::net::api_owners_test {
namespace {

using Point = std::array<float, 6>;

/// The stock of the session is 40 x 40 x 20, from -20 to 20 and from -20 to 0. Tool 1 is a ball of
/// 10 mm.
class ApiOwnersTest : public ApiRightsTest {
 protected:
  /// Cuts a groove along X, 2 mm deep, a second after the participant's previous cut.
  void groove(ParticipantId id, double y_mm) {
    for (int n = 0; n <= 100; ++n) {
      wire::MotionSample sample{.agent_sequence = ++samples_[id]};
      times_us_[id] += n == 0 ? 1'000'000 : 1'000;
      sample.time_us = times_us_[id];
      sample.tip_mm = {-10 + 0.2 * n, y_mm, -2};
      sample.tool_id = 1;
      if (n > 0) sample.buttons = wire::kButtonCutting;
      ASSERT_TRUE(session->move(id, {&sample, 1}).rejections.empty());
    }
  }
  ApiResponse send(const std::vector<Point>& points, Role role = Role::kWatcher,
                   const std::string& query = "") {
    ApiRequest request = *parse_target("/v1/sessions/block/owners" + query);
    request.method = "POST";
    request.token = tokens[role];
    request.body.resize(points.size() * sizeof(Point));
    std::memcpy(request.body.data(), points.data(), request.body.size());
    return api->handle(request);
  }
  std::vector<ParticipantId> owners(const std::vector<Point>& points,
                                    const std::string& query = "") {
    const ApiResponse response = send(points, Role::kWatcher, query);
    EXPECT_EQ(response.status, 200U) << response.body;
    std::vector<ParticipantId> values(response.body.size() / sizeof(ParticipantId));
    std::memcpy(values.data(), response.body.data(), response.body.size());
    return values;
  }

  const Point first_{0, -10, -2, 0, 0, 1}, second_{0, 5, -2, 0, 0, 1},
      untouched_{-18, -18, 0, 0, 0, 1};

 private:
  std::map<ParticipantId, std::uint64_t> samples_, times_us_;
};

TEST_F(ApiOwnersTest, NamesTheAuthorOfEachPoint) {
  const ParticipantId ada = join(tokens[Role::kSculptor]), grace = join(tokens[Role::kSculptor]);
  groove(ada, -10);
  const std::uint64_t then = session->sequence();
  groove(grace, 5);
  groove(grace, -10);  // removes nothing
  using List = std::vector<ParticipantId>;
  EXPECT_EQ(owners({second_, untouched_, first_}), (List{grace, 0, ada}));
  const auto at = "?at=" + std::to_string(then);
  // At that time the groove at y = 5 had not been cut yet.
  EXPECT_EQ(owners({first_, {0, 5, 0, 0, 0, 1}}, at), (List{ada, 0}));
  made("POST", "/v1/sessions/block/undo?participant=" + std::to_string(ada), tokens[Role::kOwner]);
  EXPECT_EQ(owners({first_, second_}), (List{grace, grace}));
}

TEST_F(ApiOwnersTest, PointsWithoutNormalOrOffTheBlockBelongToNobody) {
  const ParticipantId ada = join(tokens[Role::kSculptor]);
  groove(ada, -10);
  EXPECT_EQ(owners({{0, 0, -10, 0, 0, 0}, {1e9F, -1e9F, 3e30F, 0, 0, 1}, first_}),
            (std::vector<ParticipantId>{0, 0, ada}));
}

TEST_F(ApiOwnersTest, RejectsMalformedPoints) {
  EXPECT_EQ(send({}).status, 400U);
  EXPECT_EQ(send({{0, 0, std::numeric_limits<float>::quiet_NaN(), 0, 0, 1}}).status, 400U);
  EXPECT_EQ(send({{0, 0, 0, 0, 0, std::numeric_limits<float>::infinity()}}).status, 400U);
  ApiRequest request = *parse_target("/v1/sessions/block/owners");
  request.method = "POST";
  request.token = tokens[Role::kWatcher];
  request.body = std::string(23, 'x');
  EXPECT_EQ(Json::parse(api->handle(request).body).at("error").at("code"), "bad_points");
  tokens[Role::kWatcher].clear();
  EXPECT_EQ(send({first_}).status, 401U);
}

TEST_F(ApiOwnersTest, AuthorsAreListedAfterTheyLeave) {
  const ParticipantId id = join(tokens[Role::kSculptor]);
  const ParticipantId watcher = join(tokens[Role::kWatcher], ParticipantKind::kViewer);
  groove(id, -10);
  const std::string name = session->people().participant(id)->name;
  session->leave(id);
  const Json list = made("GET", "/v1/sessions/block/authors", tokens[Role::kWatcher]).at("authors");
  ASSERT_EQ(list.size(), 1U) << "and not watcher " << watcher;
  EXPECT_EQ(list[0].at("participant"), id);
  EXPECT_EQ(list[0].at("name"), name);
  EXPECT_EQ(list[0].at("kind"), "agent");
  EXPECT_EQ(list[0].at("color").get<std::string>().size(), 7U);
  made("GET", "/v1/sessions/block/authors", "", 401);
}

}  // namespace
}  // namespace kerf::net::api_owners_test
