// SPDX-License-Identifier: Apache-2.0
// The reason shown to the user if a server declines the connection.
#include <nlohmann/json.hpp>

#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/link/control_message.h"
#include "haptic_agent/link/traffic.h"
#include "tests/support/test.h"

namespace kerf::agent::declined_test {
namespace {

TEST(Declined, OnlyClientErrorsAreFinal) {
  EXPECT_TRUE(declined("demo", 404, "").final);
  EXPECT_FALSE(declined("demo", 429, "").final);
  EXPECT_FALSE(declined("demo", 503, "").final);
  EXPECT_EQ(declined("demo", 403, "not yours\n").reason,
            "the server rejected session 'demo': not yours (HTTP 403)");
  EXPECT_LT(declined("demo", 500, std::string(10'000, 'x')).reason.size(), 300U);
}

TEST(Declined, ShowsTheReasonWithoutJsonOrMarkup) {
  EXPECT_EQ(
      declined("demo", 404, R"({"error":{"code":"no_session","reason":"no such session"}})").reason,
      "the server rejected session 'demo': no such session (HTTP 404)");
  EXPECT_EQ(declined("demo", 400, R"({"error":"bad id"})").reason,
            "the server rejected session 'demo': bad id (HTTP 400)");
  for (const char* body : {R"({"error":{"code":7}})", R"({"a":1})", "[1]", "{\"cut", "",
                           "<html><body>502 Bad Gateway</body></html>"}) {
    EXPECT_EQ(declined("demo", 502, body).reason, "the server rejected session 'demo': HTTP 502")
        << body;
  }
}

TEST(Declined, TruncatesBetweenUtf8Characters) {
  // The euro sign has three bytes: with 198 letters before it, byte 200 is its second.
  const auto reason = [](std::size_t letters) {
    std::string text(letters, 'x');
    return text.append("€ and more");
  };
  EXPECT_EQ(reason_of_body(reason(198)), std::string(198, 'x'));
  EXPECT_EQ(reason_of_body(nlohmann::json{{"error", reason(198)}}.dump()), std::string(198, 'x'));
  EXPECT_TRUE(reason_of_body(reason(197)).ends_with("x€"));
}

TEST(Shortened, EndsBetweenCharacters) {
  EXPECT_EQ(shortened("abc", 3), "abc");
  EXPECT_EQ(shortened("abcd", 3), "abc");
  EXPECT_EQ(shortened("aä", 2), "a");
  EXPECT_EQ(shortened("aä", 3), "aä");
  EXPECT_EQ(shortened("😀", 3), "");
  EXPECT_EQ(shortened("😀😀", 7), "😀");
  EXPECT_EQ(shortened("abc", 0), "");
}

}  // namespace
}  // namespace kerf::agent::declined_test
