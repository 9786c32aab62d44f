// SPDX-License-Identifier: Apache-2.0
// Walls and grooves of a session thinner than the pitch.
#include "server/session/session_walls.h"

#include <nlohmann/json.hpp>

#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::session_walls_test {
namespace {

using testing::HasSubstr;

class SessionWalls : public SessionTest {
 protected:
  // Cuts along x at a height with the flat tool, 6 mm wide.
  void slot(Session& session, ParticipantId id, double y_mm) {
    for (const double z_mm : {5.0, -4.0})
      for (int n = -25; n <= 25; ++n) {
        wire::MotionSample sample = next(z_mm > 0 ? -n : n, y_mm, z_mm);
        sample.tool_id = 2;
        if (z_mm > 0 || n == -25) sample.buttons = 0;
        ASSERT_TRUE(session.move(id, {&sample, 1}).rejections.empty());
      }
  }
  nlohmann::json walls(Session& session) {
    EXPECT_TRUE(session.flush());
    std::ostringstream text;
    const auto written =
        export_thin_walls(session.journal_file(), session.solid().fields.front(), text);
    EXPECT_TRUE(written) << written.error();
    return nlohmann::json::parse(text.str());
  }
  static std::string scene(const std::string& accuracy) {
    std::string text = kScene;
    const auto at = text.find("\"accuracy\": {");
    return text.replace(at, text.find('}', at) + 1 - at, "\"accuracy\": " + accuracy);
  }
};

TEST_F(SessionWalls, AWallBetweenTheRaysIsReportedWithItsPlaceAndRecords) {
  const auto session = start();
  const ParticipantId id = join(*session);
  slot(*session, id, -3.1);
  EXPECT_EQ(walls(*session)["count"], 0);
  slot(*session, id, 3.1);
  const auto report = walls(*session);
  EXPECT_EQ(report["pitch_mm"], 0.5);
  EXPECT_EQ(report["target"], nullptr);
  EXPECT_GE(report["missing"], 1);
  const auto& wall = report["walls"][0];
  EXPECT_NEAR(wall["thickness_mm"], 0.2, 1e-3);
  EXPECT_NEAR(wall["at_mm"][1], 0, 1e-3);
  EXPECT_THAT(std::string(wall["place"]), testing::StartsWith("journal:"));
  EXPECT_THAT(std::string(report["warnings"][0]), HasSubstr("is missing in the result"));
}

TEST_F(SessionWalls, SaysWhetherTheTargetHoldsAtThinWalls) {
  const auto session = start(scene(R"({"target_mm": 0.5})"));
  const ParticipantId id = join(*session);
  slot(*session, id, -3.1);
  const auto kept = walls(*session)["target"];
  EXPECT_EQ(kept["target_mm"], 0.5);
  EXPECT_EQ(kept["kept"], true);
  EXPECT_EQ(kept["complete"], true);
  slot(*session, id, 3.1);
  const auto lost = walls(*session)["target"];
  EXPECT_EQ(lost["kept"], false);
  EXPECT_LE(lost["needs_pitch_mm"], 0.205);
  // The information that every session states names the exception.
  EXPECT_THAT(accuracy_json(*session->scene()),
              HasSubstr("more where a wall or groove is thinner"));
}

}  // namespace
}  // namespace kerf::session_walls_test
