// SPDX-License-Identifier: Apache-2.0
#include "server/http/api.h"
#include "tests/support/test.h"

namespace kerf::net::target_test {
namespace {

using Path = std::vector<std::string>;

TEST(Target, SplitsPathAndQuery) {
  const auto request =
      test::value_of(parse_target("/v1/sessions/demo/programs?pace=fast&name=a%20b.ngc&flag"));
  EXPECT_EQ(request.path, (Path{"v1", "sessions", "demo", "programs"}));
  EXPECT_EQ(request.query.at("pace"), "fast");
  EXPECT_EQ(request.query.at("name"), "a b.ngc");
  EXPECT_EQ(request.query.at("flag"), "");
}

TEST(Target, RootHasNoSegments) {
  EXPECT_EQ(parse_target("/")->path, Path{});
  EXPECT_EQ(parse_target("/?list")->path, Path{});
}

TEST(Target, EncodedSlashStaysInsideItsSegment) {
  EXPECT_EQ(parse_target("/a%2Fb/c")->path, (Path{"a/b", "c"}));
}

TEST(Target, RejectsMalformedTargets) {
  for (const char* bad : {"", "x", "http://host/", "*", "/%", "/%4", "/%zz", "/a%00b", "/?a=%f"}) {
    EXPECT_FALSE(parse_target(bad)) << bad;
  }
  EXPECT_FALSE(parse_target("/" + std::string(3000, 'a')));
}

TEST(SessionId, IsSafeInPathsAndUrls) {
  for (const char* good : {"demo", "a-b_c9", "0"}) EXPECT_TRUE(is_session_id(good)) << good;
  for (const char* bad : {"", ".", "..", "a/b", "A", "a b", "a\n", "ä"}) {
    EXPECT_FALSE(is_session_id(bad)) << bad;
  }
  EXPECT_FALSE(is_session_id(std::string(65, 'a')));
  EXPECT_EQ(id_from_name("Ada's Block 2"), "ada-s-block-2");
  EXPECT_TRUE(is_session_id(id_from_name("Ünïcödé")));
  EXPECT_EQ(id_from_name(""), "session");
}

}  // namespace
}  // namespace kerf::net::target_test
