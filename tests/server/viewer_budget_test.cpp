// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "server/conversation/viewer_conversation.h"
#include "tests/server/conversation_fixture.h"

namespace kerf::net::viewer_budget_test {
namespace {

class ViewerBudgetTest : public ConversationTest {};

TEST_F(ViewerBudgetTest, AHelloOrALookMayStateABudget) {
  std::unique_ptr<ViewerConversation> eve;
  const auto welcome = [&](const char* fields, std::uint32_t most) {
    eve = viewer(most);
    send_text(*eve, std::string(R"({"type":"hello")") + fields + "}");
    perform_join(*eve);
    EXPECT_TRUE(eve->has_joined());
    return messages(*eve).front();
  };
  EXPECT_FALSE(welcome("", 0).contains("budget"));
  EXPECT_EQ(eve->budget(), 0U);
  EXPECT_EQ(welcome(R"(,"budget":200000)", 0).at("budget"), 200'000);
  EXPECT_EQ(eve->budget(), 200'000U);
  // The server may limit the budget of every viewer.
  EXPECT_EQ(welcome(R"(,"budget":200000)", 100'000).at("budget"), 100'000);
  EXPECT_EQ(welcome("", 100'000).at("budget"), 100'000);
  EXPECT_EQ(welcome(R"(,"budget":25000)", 100'000).at("budget"), 25'000);
  const auto changed = [&](const char* budget) {
    send_text(*eve, std::string(R"({"type":"look","eye_mm":[0,0,90],"error_rad":0,"budget":)") +
                        budget + "}");
    const auto action = eve->take_action();
    EXPECT_TRUE(std::holds_alternative<ViewerLook>(*eve->take_action()));
    return std::get<ViewerBudget>(*action).bytes_per_s;
  };
  EXPECT_EQ(changed("50000"), 50'000U);
  EXPECT_EQ(changed("0"), 100'000U);
  EXPECT_EQ(changed("1000000000"), 100'000U);
  send_text(*eve, R"({"type":"look","eye_mm":[0,0,90],"error_rad":0.001})");
  EXPECT_TRUE(std::holds_alternative<ViewerLook>(*eve->take_action())) << "it stays as it was";
  EXPECT_FALSE(eve->has_action());
}

TEST_F(ViewerBudgetTest, AnInvalidBudgetIsRejected) {
  const auto eve = viewer();
  join_viewer(*eve);
  for (const char* budget : {"1", "24999", "1000000001", "-200000", "2.5e5", "4294992296",
                             R"("200000")", "true", "null", "[]"}) {
    const auto field = std::string(R"("budget":)") + budget + "}";
    const auto other = viewer();
    send_text(*other, R"({"type":"hello",)" + field);
    const auto errors = messages(*other);
    ASSERT_EQ(errors.size(), 1U) << budget;
    EXPECT_EQ(errors[0].at("code"), "bad_message") << budget;
    EXPECT_EQ(errors[0].at("reason"),
              "field \"budget\" must be 0 (none) or a whole number from 25000 to 1000000000 bytes "
              "per second");
    EXPECT_FALSE(other->has_action());
    send_text(*eve, R"({"type":"look","eye_mm":[0,0,90],"error_rad":0,)" + field);
    EXPECT_EQ(error_code(*eve), "bad_message") << budget;
    EXPECT_FALSE(eve->has_action());
  }
}

}  // namespace
}  // namespace kerf::net::viewer_budget_test
