// SPDX-License-Identifier: Apache-2.0
#include "server/http/response_head.h"

#include "server/http/responses.h"
#include "tests/support/test.h"

namespace kerf::net::response_head_test {
namespace {

TEST(ResponseHead, HasStatusLineFieldsAndAnEmptyLine) {
  ApiResponse response = json_response(201, "{}");
  response.headers.emplace_back("Location", "/v1/sessions/a");
  EXPECT_EQ(response_head(response, {.reason = "Created"}),
            "HTTP/1.1 201 Created\r\nServer: kerf\r\nLocation: /v1/sessions/a\r\n"
            "Content-Type: application/json\r\nContent-Length: 3\r\n\r\n");
}

TEST(ResponseHead, StatesWhetherTheConnectionStaysOpen) {
  const ApiResponse response;
  const auto has = [&](ResponseFraming framing, std::string_view field) {
    return response_head(response, framing).find(field) != std::string::npos;
  };
  EXPECT_FALSE(has({.keep_alive = true}, "Connection:"));
  EXPECT_TRUE(has({.keep_alive = false}, "\r\nConnection: close\r\n"));
  EXPECT_TRUE(has({.version = 10, .keep_alive = true}, "HTTP/1.0 "));
  EXPECT_TRUE(has({.version = 10, .keep_alive = true}, "\r\nConnection: keep-alive\r\n"));
}

TEST(ResponseHead, AnnouncesNoBodyWhereNoneIsAllowed) {
  for (const unsigned status : {204u, 304u}) {
    ApiResponse response{.status = status};
    EXPECT_EQ(response_head(response, {}).find("Content-"), std::string::npos) << status;
  }
}

}  // namespace
}  // namespace kerf::net::response_head_test
