// SPDX-License-Identifier: Apache-2.0
// Invalid messages of a viewer.
#include <utility>

#include "tests/server/conversation_fixture.h"

namespace kerf::net::viewer_mistakes_test {
namespace {

class ViewerMistakes : public ConversationTest {
 protected:
  void SetUp() override {
    ConversationTest::SetUp();
    eve = viewer();
    join_viewer(*eve);
  }
  std::unique_ptr<ViewerConversation> eve;
};

TEST_F(ViewerMistakes, EachInvalidLookGetsItsError) {
  for (const char* look :
       {R"("eye_mm":[1,2,3])", R"("error_rad":0.001)", R"("eye_mm":[1,2],"error_rad":0.001)",
        R"("eye_mm":[1,2,"3"],"error_rad":0.001)", R"("eye_mm":[1,2,1e7],"error_rad":0.001)",
        R"("eye_mm":[1,2,3],"error_rad":-0.1)", R"("eye_mm":[1,2,3],"error_rad":2)",
        R"("eye_mm":[1,2,3],"error_rad":null)"}) {
    now += std::chrono::seconds(1);
    send_text(*eve, std::string(R"({"type":"look",)") + look + "}");
    EXPECT_EQ(error_code(*eve), "bad_message") << look;
    EXPECT_FALSE(eve->has_action());
  }
}

TEST_F(ViewerMistakes, EachInvalidFrameGetsItsError) {
  const std::pair<Bytes, const char*> rows[] = {
      {Bytes(2), "bad_frame"},
      {encoded(batch()), "bad_message"},
      {encoded(wire::Ack{}, 1, kEpoch - 1), "bad_epoch"},
  };
  for (const auto& [frame, code] : rows) {
    now += std::chrono::seconds(1);
    send(*eve, frame);
    EXPECT_EQ(error_code(*eve), code);
    EXPECT_FALSE(eve->has_action());
  }
  EXPECT_EQ(session->info().motions, 0U);
}

}  // namespace
}  // namespace kerf::net::viewer_mistakes_test
