// SPDX-License-Identifier: Apache-2.0
#include "server/session/participants.h"

#include "server/platform/clock.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::participants_test {
namespace {

Sculpture sculpture_with_tools() {
  auto sculpture =
      *Sculpture::create({.stock = BoxStock{{0, 0, 0}, {10, 10, 10}}, .pitch_mm = 0.5});
  for (const ToolId tool : {1U, 2U}) {
    sculpture.apply(DefineTool{tool, *make_tool(BallShape{4, 40})}).value();
  }
  return sculpture;
}

class ParticipantsTest : public testing::Test {
 protected:
  ParticipantId join_agent() {
    return participants.join({.kind = ParticipantKind::kAgent, .name = "", .color = ""})->id;
  }

  ParticipantId join_viewer() {
    return participants.join({.kind = ParticipantKind::kViewer, .name = "", .color = ""})->id;
  }

  test::TemporaryFolder folder;
  std::filesystem::path file = folder / "demo.kerf";
  SessionLimits limits{.agents_max = 2};
  Sculpture sculpture = sculpture_with_tools();
  SessionJournal journal{*JournalWriter::create(file, {"demo", "{}", ""}), {}};
  Participants participants{limits, sculpture, journal, 1, 7};
};

TEST_F(ParticipantsTest, IdsContinueAndDefaultsAreFilledIn) {
  const auto joined =
      test::value_of(participants.join({.kind = ParticipantKind::kAgent, .name = "", .color = ""}));
  EXPECT_EQ(joined.id, 8U);
  EXPECT_EQ(joined.name, "agent 8");
  EXPECT_EQ(joined.tool, 1U);
  EXPECT_EQ(joined.color.size(), 7U);
  participants.leave(8);
  EXPECT_EQ(join_agent(), 9U) << "ids are not reused";
}

TEST_F(ParticipantsTest, EachKindHasItsOwnLimit) {
  join_agent();
  join_agent();
  const auto error =
      test::error_of(participants.join({.kind = ParticipantKind::kAgent, .name = "", .color = ""}));
  EXPECT_EQ(error.code, wire::ErrorCode::kBusy);
  EXPECT_EQ(error.reason, "the session is full: it admits at most 2 agents");
  EXPECT_TRUE(participants.join({.kind = ParticipantKind::kViewer, .name = "", .color = ""}));
}

TEST_F(ParticipantsTest, InvalidColorsAndToolsAreRejected) {
  for (const char* color : {"red", "#12345", "#12345g", "1234567"}) {
    const auto joined =
        participants.join({.kind = ParticipantKind::kAgent, .name = "", .color = color});
    ASSERT_FALSE(joined) << color;
    EXPECT_EQ(joined.error().code, wire::ErrorCode::kBadMessage);
  }
  const auto error = test::error_of(
      participants.join({.kind = ParticipantKind::kAgent, .name = "", .color = "", .tool = 3}));
  EXPECT_EQ(error.code, wire::ErrorCode::kUnknownTool);
  EXPECT_TRUE(participants.list().empty());
}

TEST_F(ParticipantsTest, OnlyParticipantsThatCarveAreJournaled) {
  join_agent();
  participants.join({.kind = ParticipantKind::kViewer, .name = "Grace", .color = ""}).value();
  ASSERT_TRUE(journal.flush());
  const auto reader = test::value_of(JournalReader::open(file));
  ASSERT_EQ(reader.participants().size(), 1U);
  EXPECT_EQ(reader.participants()[0].kind, "agent");
}

TEST_F(ParticipantsTest, ListenersAreNotifiedOfChangesOnly) {
  int events = 0;
  participants.listen([&](const SessionEvent&) { ++events; });
  const ParticipantId id = join_agent();
  EXPECT_EQ(events, 1);
  EXPECT_TRUE(participants.choose_tool(id, 1));
  EXPECT_EQ(events, 1) << "the tool did not change";
  EXPECT_TRUE(participants.choose_tool(id, 2));
  EXPECT_FALSE(participants.choose_tool(id, 3));
  EXPECT_EQ(events, 2);
  participants.leave(id);
  participants.leave(id);
  EXPECT_EQ(events, 3);
}

TEST_F(ParticipantsTest, DeferredChangesAreReportedTogether) {
  int events = 0, scheduled = 0;
  bool carvers = false;
  participants.listen([&](const SessionEvent& event) {
    ++events;
    carvers = event.carvers_changed;
  });
  participants.defer_changes([&] { ++scheduled; });
  for (int n = 0; n < 5; ++n) join_viewer();
  EXPECT_EQ(scheduled, 1);
  EXPECT_EQ(events, 0);
  participants.notify_changes();
  participants.notify_changes();
  EXPECT_EQ(events, 1);
  EXPECT_FALSE(carvers);
  join_viewer();
  join_agent();
  EXPECT_EQ(scheduled, 2);
  participants.notify_changes();
  EXPECT_EQ(events, 2);
  EXPECT_TRUE(carvers);
}

TEST_F(ParticipantsTest, MoreThanFiftyViewersAreOnlyCounted) {
  const ParticipantId agent = join_agent();
  std::vector<ParticipantId> viewers;
  for (int n = 0; n < 50; ++n) viewers.push_back(join_viewer());
  EXPECT_EQ(participants.roster().listed.size(), 51U);
  const ParticipantId last = join_viewer();
  const Roster many = participants.roster();
  ASSERT_EQ(many.listed.size(), 1U);
  EXPECT_EQ(many.listed[0].id, agent);
  EXPECT_EQ(many.viewers, 51U);
  participants.leave(last);
  EXPECT_EQ(participants.roster().listed.size(), 51U);
  participants.leave(agent);
  EXPECT_EQ(participants.roster().viewers, 50U);
}

TEST_F(ParticipantsTest, RosterChangeReproducesTheNextRoster) {
  const Roster none = participants.roster();
  const ParticipantId one = join_agent(), two = join_agent();
  const ParticipantId three = join_viewer();
  const Roster before = participants.roster();
  EXPECT_EQ(difference(none, before).changed.size(), 3U);
  participants.leave(one);
  ASSERT_TRUE(participants.choose_tool(two, 2));
  const Roster after = participants.roster();
  const RosterChange change = difference(before, after);
  EXPECT_EQ(change.left, std::vector<ParticipantId>{one});
  ASSERT_EQ(change.changed.size(), 1U);
  EXPECT_EQ(change.changed[0].id, two);
  EXPECT_EQ(change.changed[0].tool, 2U);
  EXPECT_EQ(change.viewers, 1U);
  EXPECT_FALSE(is_same(before, after));
  EXPECT_TRUE(is_same(after, participants.roster()));
  EXPECT_EQ(difference(after, none).left, (std::vector<ParticipantId>{two, three}));
}

TEST_F(ParticipantsTest, RepeatedJoinsAreRejected) {
  std::size_t joined = 0;
  for (int n = 0; n < 10'000; ++n) {
    const auto viewer =
        participants.join({.kind = ParticipantKind::kViewer, .name = "", .color = ""});
    if (!viewer) {
      EXPECT_EQ(viewer.error().code, wire::ErrorCode::kBusy);
      break;
    }
    ++joined;
    participants.leave(viewer->id);
  }
  EXPECT_GE(joined, 1000U) << "an audience that arrives at once is let in";
  EXPECT_LT(joined, 10'000U);
}

TEST(RateLimit, FutureTokenIsReservedForAWaitingCaller) {
  RateLimit limit(2, 3);
  Clock::time_point now{std::chrono::hours(1)};
  for (int n = 0; n < 3; ++n) EXPECT_EQ(limit.take(now, 1), 0.0);
  EXPECT_EQ(limit.take(now, 1), 0.5);
  EXPECT_EQ(limit.take(now, 1), 1.0);
  EXPECT_FALSE(limit.take(now, 1)) << "it would wait longer";
  EXPECT_FALSE(limit.allow(now));
  now += std::chrono::milliseconds(500);
  EXPECT_EQ(limit.take(now, 1), 1.0) << "after those that wait";
  now += std::chrono::milliseconds(1500);
  EXPECT_TRUE(limit.allow(now));
}

TEST_F(ParticipantsTest, ViewerTurnsAreLimitedToTheMaximumOfViewers) {
  std::size_t turns = 0;
  double last_s = 0;
  while (const auto wait_s = participants.viewer_turn()) {
    EXPECT_LE(*wait_s, limits.viewer_wait_max_s);
    EXPECT_GE(*wait_s, turns < 1000 ? 0.0 : last_s - 0.5) << "one after the other";
    last_s = *wait_s;
    ASSERT_LT(++turns, 10'000U);
  }
  EXPECT_GE(turns, limits.viewers_max);
  JoinRequest request{.kind = ParticipantKind::kViewer, .name = "", .color = ""};
  EXPECT_FALSE(participants.join(request)) << "it has not waited";
  request.has_turn = true;
  EXPECT_TRUE(participants.join(request));
  request.kind = ParticipantKind::kAgent;
  for (int n = 0; n < 200; ++n) {
    const auto joined = participants.join(request);
    if (!joined) return;
    participants.leave(joined->id);
  }
  ADD_FAILURE() << "agents do not wait: their joins are limited";
}

TEST_F(ParticipantsTest, PresentAgentCanAlwaysResume) {
  const SessionLimits many{.agents_max = 2, .carver_joins_per_s = 1e9, .carver_joins_burst = 1e9};
  Participants others{many, sculpture, journal, 1, 0};
  const auto admit = [&](const std::string& token) {
    return others
        .admit({.kind = ParticipantKind::kAgent,
                .name = "",
                .color = "",
                .durable = true,
                .token = token})
        .value();
  };
  const Admission ada = admit("");
  std::vector<std::string> tokens;
  for (std::size_t n = 0; n < Resumable::kKept + 10; ++n) {
    const Admission other = admit("");
    tokens.push_back(other.token);
    others.leave(other.participant.id);
  }
  EXPECT_EQ(admit(ada.token).participant.id, ada.participant.id);
  const Admission last = admit(tokens.back());
  EXPECT_TRUE(last.resumed);
  others.leave(last.participant.id);
  // The remaining absent agents are only in the journal.
  ASSERT_TRUE(journal.flush());
  for (const std::string& token : tokens) {
    const Admission again = admit(token);
    EXPECT_TRUE(again.resumed);
    EXPECT_EQ(again.token, token);
    others.leave(again.participant.id);
  }
}

TEST_F(ParticipantsTest, ResumingIsLimitedPerAgent) {
  JoinRequest request{.kind = ParticipantKind::kAgent, .name = "", .color = "", .durable = true};
  const JoinRequest plain{.kind = ParticipantKind::kAgent, .name = "", .color = ""};
  const auto ada = participants.admit(request), bob = participants.admit(request);
  ASSERT_TRUE(ada && bob);
  participants.leave(bob->participant.id);
  for (int n = 0; n < 10'000; ++n) {
    const auto other = participants.join(plain);
    if (!other) break;
    participants.leave(other->id);
  }
  ASSERT_FALSE(participants.join(plain));
  int resumed = 0;
  request.token = ada->token;
  while (resumed < 10'000 && participants.admit(request)) ++resumed;
  EXPECT_GE(resumed, 10);
  EXPECT_LT(resumed, 10'000);
  request.token = bob->token;
  EXPECT_TRUE(participants.admit(request)) << "the limit is that of one agent";
}

TEST_F(ParticipantsTest, ListenersMayUnlistenDuringANotification) {
  int first_events = 0, second_events = 0;
  int first = 0, second = 0;
  first = participants.listen([&](const SessionEvent&) {
    ++first_events;
    participants.unlisten(first);
    participants.unlisten(second);
  });
  second = participants.listen([&](const SessionEvent&) { ++second_events; });
  participants.notify({});
  participants.notify({});
  EXPECT_EQ(first_events, 1);
  EXPECT_EQ(second_events, 0);
}

}  // namespace
}  // namespace kerf::participants_test
