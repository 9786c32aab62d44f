// SPDX-License-Identifier: Apache-2.0
// Invalid scenes, ids and resources over HTTP.
#include <string>

#include "tests/server/whole/whole_server.h"

namespace kerf::test::scenes_test {
namespace {

using Scenes = WholeServer;

TEST_F(Scenes, InvalidScenesCreateNoSession) {
  const std::string sessions = "/v1/sessions";
  EXPECT_EQ(error("POST", sessions, "{"), "400 bad_scene");
  EXPECT_EQ(error("POST", sessions, ""), "400 bad_scene");
  for (const Json& pitch : {Json(0), Json(-1), Json("fine"), Json(1e-9), Json()}) {
    Json scene = kBlock;
    scene["accuracy"]["pitch_mm"] = pitch;
    EXPECT_EQ(error("POST", sessions, scene.dump()), "400 bad_scene") << pitch;
  }
  EXPECT_EQ(error("POST", sessions, std::string(1 << 20, ' ') + "{}"), "413 too_large");
  EXPECT_EQ(made("GET", sessions).at("sessions").size(), 1U);
}

TEST_F(Scenes, CannotReadFilesOfTheServer) {
  const Json obstacle = {{"shape", "stl"}, {"file", "/etc/passwd"}};
  const Json scene = scene_with({{"obstacles", Json::array({obstacle})}});
  EXPECT_EQ(error("POST", "/v1/sessions", scene.dump()), "400 bad_scene");
}

TEST_F(Scenes, SessionIdsAreSafe) {
  for (const std::string& id : {std::string(".."), std::string("a/b"), std::string("%2e%2e%2fx"),
                                std::string("Upper"), std::string(65, 'a'), std::string("a%00b")}) {
    EXPECT_EQ(ask("POST", "/v1/sessions?id=" + id, kBlock.dump()).status, 400U) << id;
  }
  EXPECT_EQ(error("POST", "/v1/sessions?id=block", kBlock.dump()), "409 session_exists");
}

TEST_F(Scenes, UnknownResourcesAreNamed) {
  EXPECT_EQ(error("GET", "/v1/sessions/nobody"), "404 unknown_session");
  EXPECT_EQ(error("DELETE", "/v1/sessions/nobody"), "404 unknown_session");
  EXPECT_EQ(error("GET", "/v1/sessions/nobody/model.stl"), "404 unknown_session");
  EXPECT_EQ(error("GET", "/v1/sessions/block/model.exe"), "404 not_found");
  EXPECT_EQ(error("GET", "/v1/sessions/block/programs/7"), "404 unknown_program");
  EXPECT_EQ(error("GET", "/%zz"), "400 bad_target");
  EXPECT_EQ(error("PUT", "/v1/sessions/block"), "405 bad_method");
}

}  // namespace
}  // namespace kerf::test::scenes_test
