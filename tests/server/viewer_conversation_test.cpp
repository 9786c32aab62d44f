// SPDX-License-Identifier: Apache-2.0
#include "server/conversation/viewer_conversation.h"

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/server/conversation_fixture.h"

namespace kerf::net::viewer_conversation_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Kind = OutFrame::Kind;

constexpr const char* kLook = R"({"type":"look","eye_mm":[0,0,90],"error_rad":0.001})";

SharedBytes shared(std::size_t bytes) { return std::make_shared<const Bytes>(bytes); }
SharedText shared(const char* text) { return std::make_shared<const std::string>(text); }

class ViewerConversationTest : public ConversationTest {
 protected:
  void SetUp() override {
    ConversationTest::SetUp();
    eve = viewer();
  }
  std::unique_ptr<ViewerConversation> eve;
};

TEST_F(ViewerConversationTest, AHelloIsAnActionThatIsAnsweredAfterTheJoin) {
  send_text(*eve, R"({"type":"hello","name":"Eve","color":"#112233"})");
  EXPECT_TRUE(eve->has_action());
  EXPECT_TRUE(drain(*eve).empty());
  perform_join(*eve);
  const auto list = messages(*eve);
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].at("type"), "welcome");
  EXPECT_EQ(list[0].at("color"), "#112233");
  EXPECT_TRUE(list[0].contains("grid"));
  EXPECT_EQ(list[0].at("name"), session->scene()->name);
}

TEST_F(ViewerConversationTest, QueuedViewerNeedsNoSecondHello) {
  send_text(*eve, R"({"type":"hello","name":"Eve"})");
  eve->hello_expired();
  EXPECT_FALSE(eve->finishing());
  eve->joined(std::unexpected(Rejection{wire::ErrorCode::kBadMessage, "a bad name"}), {});
  eve->hello_expired();
  EXPECT_TRUE(eve->finishing()) << "the hello was rejected, and no other one came";
}

TEST_F(ViewerConversationTest, ARejectedHelloMayBeRepeated) {
  send_text(*eve, R"({"type":"hello","color":"red"})");
  perform_join(*eve);
  EXPECT_EQ(error_code(*eve), "bad_message");
  EXPECT_FALSE(eve->has_joined());
  EXPECT_FALSE(eve->finishing());
  join_viewer(*eve);
}

TEST_F(ViewerConversationTest, AHelloMayStateTheFirstLook) {
  send_text(*eve, R"({"type":"hello","look":{"eye_mm":[0,0,90],"error_rad":0.001}})");
  perform_join(*eve);
  ASSERT_TRUE(eve->first_look().look);
  EXPECT_EQ(eve->first_look().look->eye_mm.z, 90);
  EXPECT_EQ(eve->first_look().look->error_rad, 0.001);
  EXPECT_FALSE(eve->first_look().follows);
  EXPECT_EQ(eve->first_look().nodes, TileNodes::kSingle);
  const auto later = viewer();
  send_text(*later, R"({"type":"hello","look":true})");
  EXPECT_TRUE(later->first_look().follows);
  const auto new_viewer = viewer();
  send_text(*new_viewer, R"({"type":"hello","repeat":true})");
  EXPECT_EQ(new_viewer->first_look().nodes, TileNodes::kRepeated);
  EXPECT_FALSE(later->first_look().look);
}

TEST_F(ViewerConversationTest, AHelloWithAnInvalidLookIsRejected) {
  for (const char* look :
       {"1", "[]", "null", "{}", R"({"eye_mm":[0,0,90]})",
        R"({"eye_mm":[0,0,1e9],"error_rad":0.001})", R"({"eye_mm":[0,0,90],"error_rad":2})"}) {
    const auto other = viewer();
    send_text(*other, std::string(R"({"type":"hello","look":)") + look + "}");
    EXPECT_EQ(error_code(*other), "bad_message") << look;
    EXPECT_FALSE(other->has_action());
  }
}

TEST_F(ViewerConversationTest, LooksAreLimitedToFivePerSecond) {
  join_viewer(*eve);
  int looks = 0;
  for (int ms = 0; ms < 10'000; ms += 10) {
    now += milliseconds(10);
    send_text(*eve, kLook);
    while (eve->take_action()) ++looks;
    for (const auto& message : messages(*eve)) {
      EXPECT_EQ(message.at("code"), "too_fast");
      EXPECT_EQ(message.at("reason"), "'look' is limited to 5 per second");
    }
  }
  EXPECT_GE(looks, 69);
  EXPECT_LE(looks, 71);
}

TEST_F(ViewerConversationTest, ASeekIsAnAction) {
  join_viewer(*eve);
  const auto seek = [&](const char* fields) {
    send_text(*eve, std::string(R"({"type":"seek")") + fields + "}");
    const auto action = eve->take_action();
    EXPECT_TRUE(action) << fields;
    return action ? std::get<SeekMessage>(*action) : SeekMessage{};
  };
  EXPECT_EQ(seek(R"(,"at":17)").record, 17U);
  EXPECT_EQ(seek(R"(,"at":17)").rate, 0);
  EXPECT_FALSE(seek(R"(,"at":17)").is_live);
  EXPECT_EQ(seek(R"(,"at":17,"rate":0.25)").rate, 0.25);
  EXPECT_TRUE(seek(R"(,"at":"live")").is_live);
  EXPECT_EQ(seek(R"(,"rate":64)").rate, 64);
  EXPECT_FALSE(seek(R"(,"rate":64)").record);
  for (const char* fields :
       {R"(,"at":-1)", R"(,"at":"now")", R"(,"at":1.5)", R"(,"at":null)", R"(,"at":1,"rate":65)",
        R"(,"at":1,"rate":0.2)", R"(,"at":1,"rate":-1)", R"(,"at":1,"rate":"fast")"}) {
    send_text(*eve, std::string(R"({"type":"seek")") + fields + "}");
    EXPECT_EQ(error_code(*eve), "bad_message") << fields;
    EXPECT_FALSE(eve->has_action());
  }
  int accepted = 0;
  for (int n = 0; n < 50; ++n) {
    send_text(*eve, R"({"type":"seek","at":1})");
    while (eve->take_action()) ++accepted;
  }
  EXPECT_EQ(accepted, 40 - 7);
  EXPECT_EQ(messages(*eve).back().at("code"), "too_fast");
}

TEST_F(ViewerConversationTest, ACameraIsAnAction) {
  join_viewer(*eve);
  const auto shown = [&](const std::string& fields) {
    send_text(*eve, R"({"type":"camera")" + fields + "}");
    const auto action = eve->take_action();
    EXPECT_TRUE(action) << fields;
    return action ? std::get<CameraMessage>(*action).camera : std::nullopt;
  };
  const std::string pose = R"(,"eye_mm":[1,2,3],"target_mm":[4,5,6])";
  EXPECT_EQ(shown(pose)->eye_mm.y, 2);
  EXPECT_EQ(shown(pose)->target_mm.z, 6);
  EXPECT_FALSE(shown(pose)->is_parallel);
  EXPECT_TRUE(shown(pose + R"(,"parallel":true)")->is_parallel);
  EXPECT_FALSE(shown(""));
  for (const char* fields :
       {R"(,"eye_mm":[1,2,3])", R"(,"target_mm":[1,2,3])", R"(,"eye_mm":[1,2],"target_mm":[4,5,6])",
        R"(,"eye_mm":[1,2,"3"],"target_mm":[4,5,6])", R"(,"eye_mm":[1,2,1e7],"target_mm":[4,5,6])",
        R"(,"eye_mm":[1,2,3],"target_mm":[4,5,6],"parallel":1)"}) {
    send_text(*eve, std::string(R"({"type":"camera")") + fields + "}");
    EXPECT_EQ(error_code(*eve), "bad_message") << fields;
    EXPECT_FALSE(eve->has_action());
  }
  int accepted = 0;
  for (int n = 0; n < 50; ++n) {
    send_text(*eve, R"({"type":"camera")" + pose + "}");
    while (eve->take_action()) ++accepted;
  }
  EXPECT_EQ(accepted, 40 - 5);
  EXPECT_EQ(messages(*eve).back().at("code"), "too_fast");
}

TEST_F(ViewerConversationTest, NewBlockBeginsWithAWelcomeAndContinuesFrameNumbers) {
  join_viewer(*eve);
  const auto sequence_of = [](const OutFrame& frame) {
    std::uint64_t number = 0;
    std::memcpy(&number, frame.bytes.data() + 16, sizeof number);
    return number;
  };
  const auto acked = [&](std::uint64_t number) {
    send(*eve, encoded(wire::Ack{}, number));
    const auto action = eve->take_action();
    return action ? std::get<MeshAck>(*action).sequence : 0;
  };
  eve->send_mesh({.sequence = 1, .glb = shared(10)});
  eve->send_mesh({.sequence = 2, .glb = shared(10)});
  drain(*eve);
  eve->send_mesh({.sequence = 3, .glb = shared(10)});
  eve->send_state({.sequence = 1, .hash = 7, .settled = true});
  eve->begin_again(session->roster());
  eve->send_mesh({.sequence = 1, .glb = shared(20)});
  eve->send_state({.sequence = 1, .hash = 7, .settled = true, .past = PastPlace{1, 2000, 4}});
  const auto frames = drain(*eve);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_TRUE(text_of(frames[0]).contains("welcome"));
  EXPECT_EQ(frames[1].shared->size(), 20U);
  EXPECT_EQ(sequence_of(frames[1]), 4U);
  EXPECT_TRUE(text_of(frames[2]).contains(R"("at":{"rate":4.0,"record":1,"time_ms":2000})"));
  EXPECT_EQ(acked(2), 0U);
  EXPECT_EQ(acked(4), 1U);
}

TEST_F(ViewerConversationTest, AcksBecomeActionsOnceTheViewerHasJoined) {
  send(*eve, encoded(wire::Ack{}, 3));
  EXPECT_EQ(error_code(*eve), "no_hello");
  join_viewer(*eve);
  send(*eve, encoded(wire::Ack{}, 3));
  const auto action = eve->take_action();
  ASSERT_TRUE(action);
  EXPECT_EQ(std::get<MeshAck>(*action).sequence, 3U);
  eve->reject_ack();
  EXPECT_EQ(error_code(*eve), "bad_sequence");
}

TEST_F(ViewerConversationTest, ViewersHaveNoToolAndSendNoMotions) {
  join_viewer(*eve);
  send_text(*eve, R"({"type":"tool","tool":1})");
  EXPECT_EQ(error_code(*eve), "bad_message");
  send(*eve, encoded(batch()));
  EXPECT_EQ(error_code(*eve), "bad_message");
  EXPECT_EQ(session->info().motions, 0U);
}

TEST_F(ViewerConversationTest, FramesAreSentByPriority) {
  join_viewer(*eve);
  eve->send_state({.sequence = 1, .hash = 7, .settled = true});
  eve->send_mesh({.sequence = 1, .glb = shared(10)});
  eve->send_mesh({.sequence = 2, .glb = shared(20)});
  eve->send_tools(shared(30));
  eve->send_programs(shared("old"));
  eve->send_programs(shared("{}"));
  eve->send_cameras(shared("old"));
  eve->send_cameras(shared("{}"));
  eve->send_matter(0, shared("{}"));
  eve->send_participants(shared("{}"), shared("{}"));
  eve->reject_ack();
  const auto frames = drain(*eve);
  ASSERT_EQ(frames.size(), 9U);
  const std::vector<Kind> kinds = {Kind::kText,     Kind::kTools,  Kind::kParticipants,
                                   Kind::kPrograms, Kind::kMatter, Kind::kCameras,
                                   Kind::kMesh,     Kind::kMesh,   Kind::kState};
  for (std::size_t n = 0; n < kinds.size(); ++n) EXPECT_EQ(frames[n].kind, kinds[n]) << n;
  EXPECT_EQ(text_of(frames[3]), "{}");
  EXPECT_EQ(text_of(frames[5]), "{}");
  for (const int n : {3, 4, 5}) EXPECT_TRUE(frames[n].is_text());
  EXPECT_EQ(frames[6].bytes.size(), std::size_t{wire::kHeaderBytes});
  EXPECT_EQ(frames[6].shared->size(), 10U);
  EXPECT_EQ(frames[7].shared->size(), 20U);
}

TEST(ProgramsMessage, IsTheGoldenOne) {
  ProgramGlance running{.id = 3,
                        .participant = 12,
                        .name = "bracket.ngc",
                        .pace = ProgramPace::kFeed,
                        .speed = 2.5,
                        .motions_done = 150,
                        .motions = 600,
                        .line = 41,
                        .tool = 2,
                        .elapsed_s = 20,
                        .programmed_s = 80,
                        .feed_mm_per_min = 900,
                        .removed_mm3 = 12.5,
                        .alarm_count = 1};
  ProgramGlance queued{.id = 4,
                       .participant = 13,
                       .name = "chamfer.ngc",
                       .state = ProgramState::kQueued,
                       .after = 3,
                       .motions = 7,
                       .tool = 1,
                       .programmed_s = 3};
  ProgramGlance failed{.id = 2,
                       .participant = 11,
                       .name = "old.ngc",
                       .state = ProgramState::kFailed,
                       .motions_done = 4,
                       .motions = 8,
                       .line = 9,
                       .tool = 1,
                       .elapsed_s = 1,
                       .programmed_s = 2,
                       .error = "old.ngc:9: too far"};
  std::ifstream file(KERF_SOURCE_DIR "/tests/wire/golden/programs.json");
  EXPECT_EQ(nlohmann::json::parse(programs_message({running, queued, failed})),
            nlohmann::json::parse(file));
}

TEST_F(ViewerConversationTest, NewerToolPosesReplaceOlderOnes) {
  join_viewer(*eve);
  eve->send_tools(shared(10));
  eve->send_tools(shared(20));
  const auto frames = drain(*eve);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].shared->size(), 20U);
}

TEST_F(ViewerConversationTest, AParticipantChangeIsSentToAViewerThatKnowsTheListBefore) {
  send_text(*eve, R"({"type":"hello","changes":true})");
  perform_join(*eve);
  drain(*eve);
  const auto sent = [&](bool reads) {
    eve->send_participants(shared("all"), shared("change"));
    if (!reads) return std::string();
    const auto frames = drain(*eve);
    return frames.size() == 1 ? text_of(frames[0]) : "not one frame";
  };
  EXPECT_EQ(sent(true), "all") << "the welcome may be older than the list before";
  EXPECT_EQ(sent(true), "change");
  sent(false);
  EXPECT_EQ(sent(true), "all") << "a change that was not read is replaced by the list";
  EXPECT_EQ(sent(true), "change");
}

TEST_F(ViewerConversationTest, ViewersWithoutDeltaSupportGetLists) {
  join_viewer(*eve);
  for (int n = 0; n < 3; ++n) {
    eve->send_participants(shared("all"), shared("change"));
    EXPECT_EQ(text_of(drain(*eve).at(0)), "all");
  }
}

TEST_F(ViewerConversationTest, StalledViewerSurvivesAnyNumberOfParticipantChanges) {
  join_viewer(*eve);
  for (int n = 0; n < 1000; ++n) eve->send_participants(shared("all"), shared("change"));
  EXPECT_FALSE(eve->broken());
  EXPECT_EQ(drain(*eve).size(), 1U);
}

TEST_F(ViewerConversationTest, AWelcomeCountsTheViewersBeyondFifty) {
  for (int n = 0; n < 60; ++n) {
    ASSERT_TRUE(session->join({.kind = ParticipantKind::kViewer, .name = "", .color = ""}));
  }
  send_text(*eve, R"({"type":"hello"})");
  perform_join(*eve);
  const auto welcome = messages(*eve).at(0);
  EXPECT_EQ(welcome.at("viewers"), 61U);
  EXPECT_TRUE(welcome.at("participants").empty());
}

TEST_F(ViewerConversationTest, TextFramesAreLimitedToAHundredPerSecond) {
  join_viewer(*eve);
  for (int n = 0; n < 10'000; ++n) send_text(*eve, "not JSON");
  std::size_t read = 0;
  for (const auto& message : messages(*eve)) read += message.at("code") == "bad_json" ? 1 : 0;
  EXPECT_FALSE(eve->broken());
  now += seconds(1);
  send_text(*eve, "not JSON");
  EXPECT_EQ(error_code(*eve), "bad_json");
  for (int n = 0; n < 99; ++n) send_text(*eve, "not JSON");
  for (int n = 0; n < 100; ++n) {
    send_text(*eve, kLook);
    EXPECT_FALSE(eve->has_action()) << "it was read";
  }
  EXPECT_LE(read, 50U);
}

TEST_F(ViewerConversationTest, StatesAreSentEveryQuarterSecondAndAtOnceWhenSettled) {
  join_viewer(*eve);
  int sent = 0;
  for (int ms = 0; ms < 2000; ms += 33) {
    now += milliseconds(33);
    const auto number = static_cast<std::uint64_t>(ms);
    eve->send_state({.sequence = number, .hash = number});
    sent += static_cast<int>(drain(*eve).size());
  }
  EXPECT_EQ(sent, 8);
  eve->send_state({.sequence = 1000, .hash = 1000, .settled = true});
  EXPECT_EQ(drain(*eve).size(), 1U);
  eve->send_state({.sequence = 1000, .hash = 1000, .settled = true});
  EXPECT_TRUE(drain(*eve).empty());
}

TEST_F(ViewerConversationTest, PosesAreSentBeforeTheirTiles) {
  join_viewer(*eve);
  eve->send_mesh({.sequence = 1, .glb = shared(10)}, shared(30));
  OutFrame frame;
  ASSERT_TRUE(eve->take(frame));
  EXPECT_EQ(frame.kind, Kind::kTools);
  EXPECT_TRUE(eve->has_more());
  ASSERT_TRUE(eve->take(frame));
  EXPECT_EQ(frame.kind, Kind::kMesh);
  EXPECT_FALSE(eve->has_more());
}

TEST_F(ViewerConversationTest, CloseSendsAByeAndNothingAfterIt) {
  join_viewer(*eve);
  eve->send_mesh({.sequence = 1, .glb = shared(10)});
  eve->close("maintenance");
  eve->send_tools(shared(10));
  eve->send_participants(shared("{}"), shared("{}"));
  eve->reject_ack();
  const auto list = messages(*eve);
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].at("type"), "bye");
  EXPECT_TRUE(eve->finishing());
}

}  // namespace
}  // namespace kerf::net::viewer_conversation_test
