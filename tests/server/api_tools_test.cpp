// SPDX-License-Identifier: Apache-2.0
// Tools that are made over HTTP, and who hears of them.
#include "server/store/journal_origin.h"
#include "server/tools/tool_routes.h"
#include "tests/server/api_rights_fixture.h"
#include "tests/server/conversation_fixture.h"
#include "tests/support/test.h"
#include "web/wasm/files/journal_block.h"

namespace kerf::net::api_tools_test {
namespace {

const std::string kTools = "/v1/sessions/block/tools";
constexpr const char* kWide =
    R"({"shape":"bull_nose","diameter_mm":14,"corner_radius_mm":2,"length_mm":50})";

class ApiTools : public ApiRightsTest {
 protected:
  ApiResponse post(const std::string& body, Role role, const std::string& query = "") {
    return ask("POST", kTools + query, tokens[role], body);
  }
  Json answer(const std::string& body, unsigned status, Role role = Role::kSculptor,
              const std::string& query = "") {
    const ApiResponse response = post(body, role, query);
    EXPECT_EQ(response.status, status) << response.body;
    return Json::parse(response.body);
  }
};

TEST_F(ApiTools, AreMadeBySculptorsAndSeenByWatchers) {
  const Json made_one = answer(kWide, 201, Role::kSculptor, "?author=Ada");
  EXPECT_EQ(made_one.at("new"), true);
  EXPECT_EQ(made_one.at("tool").at("id"), 3);
  EXPECT_EQ(made_one.at("tool").at("shape"), "bull_nose");
  EXPECT_EQ(answer(kWide, 200).at("new"), false);
  const Json list = made("GET", kTools, tokens[Role::kWatcher]);
  EXPECT_EQ(list.at("tools").size(), 3U);
  EXPECT_EQ(list.at("made").size(), 1U);
  EXPECT_EQ(list.at("made")[0].at("tool"), 3);
  EXPECT_EQ(list.at("made")[0].at("author"), "Ada");
  EXPECT_EQ(made("GET", "/v1/sessions/block", tokens[Role::kWatcher]).at("tools"),
            list.at("tools"));
  EXPECT_EQ(post(kWide, Role::kWatcher).status, 403U);
}

TEST_F(ApiTools, OfNoUseAreRejected) {
  const auto code = [&](const std::string& body) {
    return answer(body, 422).at("error").at("code").get<std::string>();
  };
  for (const char* bad : {"", "{", "[]", "{}", R"({"shape":"spoon","diameter_mm":1,"length_mm":1})",
                          R"({"shape":"ball","diameter_mm":-1,"length_mm":1})",
                          R"({"shape":"ball","diameter_mm":1,"length_mm":1,"color":"red"})",
                          R"({"id":0,"shape":"ball","diameter_mm":1,"length_mm":1})"}) {
    EXPECT_EQ(code(bad), "bad_tool") << bad;
  }
  EXPECT_EQ(
      answer(kWide, 400, Role::kSculptor, "?author=" + std::string(65, 'x')).at("error").at("code"),
      "bad_name");
}

/// Bug: after a jump over the record of a tool the page could not cut with it.
TEST_F(ApiTools, APageThatReplaysTheJournalHasThem) {
  const ParticipantId ada = join(tokens[Role::kSculptor]);
  std::uint64_t sequence = 0;
  const auto cut = [&](double x, double y, ToolId tool) {
    const wire::MotionSample sample{.agent_sequence = ++sequence,
                                    .time_us = 1000 * sequence,
                                    .tip_mm = {x, y, -3},
                                    .tool_id = tool,
                                    .buttons = wire::kButtonCutting};
    EXPECT_TRUE(session->move(ada, {&sample, 1}).rejections.empty());
  };
  for (int n = 0; n < 20; ++n) cut(-15 + n, 0, 1);
  const ToolId wide = answer(kWide, 201).at("tool").at("id");
  for (int n = 0; n < 40; ++n) cut(-15 + n / 2.0, 8, wide);
  const Json now = made("GET", "/v1/sessions/block/replay", tokens[Role::kWatcher]);
  const std::string journal = now.at("journal");
  const auto bytes = [&](const std::string& target) {
    return ask("GET", "/v1/sessions/block/" + target, tokens[Role::kWatcher]).body;
  };
  const std::string origin = bytes("origin?journal=" + journal);
  const std::string rows = bytes("records?journal=" + journal + "&first=1&last=" +
                                 std::to_string(now.at("record").get<std::uint64_t>()));
  auto block = test::value_of(page::JournalBlock::read(std::as_bytes(std::span(origin))));
  ASSERT_TRUE(block.add(std::as_bytes(std::span(rows))));
  ASSERT_TRUE(block.make());
  ASSERT_TRUE(block.seek(30));
  const auto carved = block.carve(1000, true);
  ASSERT_TRUE(carved) << carved.error();
  EXPECT_EQ(block.hash(), session->solid().hash());
}

using ToolMessages = ConversationTest;

TEST_F(ToolMessages, AgentsAndViewersGetAllToolsWhenOneIsMade) {
  const auto ada = agent();
  join_agent(*ada);
  messages(*ada);
  const auto tool = parse_scene_tool(kWide, 0.01);
  ASSERT_TRUE(session->tools().make(*tool, ""));
  const auto heard = messages(*ada);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0].at("type"), "tools");
  EXPECT_EQ(heard[0].at("tools").size(), 3U);
  EXPECT_EQ(heard[0].at("tools")[2].at("id"), 3);
  const auto frame = session->frame(false);
  ASSERT_EQ(frame.matters.size(), 1U);
  EXPECT_EQ(nlohmann::json::parse(frame.matters[0].text), heard[0]);
  EXPECT_TRUE(session->frame(false).matters.empty());
  ASSERT_TRUE(session->tools().make(*tool, ""));
  EXPECT_TRUE(messages(*ada).empty()) << "nothing is new";
}

/// A hand without a server makes its tools itself.
TEST(PageTools, AreMadeByTheHandOfAPage) {
  const auto scene = test::value_of(parse_scene(kScene, {}));
  JournalOrigin origin{.session = "own", .scene_json = scene_json(scene), .files = {}};
  auto block = test::value_of(page::JournalBlock::read(encode_origin(origin)));
  std::vector<BatchRecord> records;
  for (const auto& [id, tool] : scene.tools)
    records.push_back({0, DefineTool{id, tool.tool}, false});
  block.append(records, 1000);
  ASSERT_TRUE(block.make());
  ASSERT_TRUE(block.carve(10, true));
  EXPECT_FALSE(block.make_tool(kWide, 2000)) << "no hand";
  block.begin_hand(5);
  EXPECT_FALSE(block.make_tool("{}", 2000));
  EXPECT_EQ(block.make_tool(kWide, 2000).value(), 3U);
  EXPECT_EQ(block.make_tool(kWide, 2000).value(), 3U);
  const auto about = nlohmann::json::parse(block.about());
  EXPECT_EQ(about.at("tools").size(), 3U);
  EXPECT_EQ(about.at("made"),
            nlohmann::json::parse(R"([{"tool":3,"record":3,"created_ms":2000}])"));
  std::vector<wire::MotionSample> samples;
  for (std::uint64_t n = 1; n <= 10; ++n) {
    samples.push_back({.agent_sequence = n,
                       .time_us = 1000 * n,
                       .tip_mm = {double(n), 0, -2},
                       .tool_id = 3,
                       .buttons = wire::kButtonCutting});
  }
  ASSERT_TRUE(block.carve_by_hand(samples, 3000, 10));
  const std::uint64_t cut = block.hash();
  ASSERT_TRUE(block.change_by_hand(true, 4000));
  EXPECT_NE(block.hash(), cut);
  ASSERT_TRUE(block.change_by_hand(false, 5000));
  EXPECT_EQ(block.hash(), cut);
}

}  // namespace
}  // namespace kerf::net::api_tools_test
