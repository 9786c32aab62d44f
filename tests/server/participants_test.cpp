// SPDX-License-Identifier: Apache-2.0
#include "server/session/participants.h"

#include <gtest/gtest.h>

#include "tests/server/temporary_folder.h"

namespace kerf {
namespace {

Sculpture sculpture_with_tools() {
  SculptureSettings settings;
  settings.stock = BoxStock{{0, 0, 0}, {10, 10, 10}};
  settings.pitch_mm = 0.5;
  auto sculpture = *Sculpture::create(settings);
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

  test::TemporaryFolder folder;
  std::filesystem::path file = folder / "demo.kerf";
  SessionLimits limits{.agents_max = 2};
  Sculpture sculpture = sculpture_with_tools();
  SessionJournal journal{*JournalWriter::create(file, {"demo", "{}", ""}), {}};
  Participants participants{limits, sculpture, journal, 1, 7};
};

TEST_F(ParticipantsTest, IdsContinueAndDefaultsAreFilledIn) {
  const auto joined = participants.join({.kind = ParticipantKind::kAgent, .name = "", .color = ""});
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->id, 8U);
  EXPECT_EQ(joined->name, "agent 8");
  EXPECT_EQ(joined->tool, 1U);
  EXPECT_EQ(joined->color.size(), 7U);
  participants.leave(8);
  EXPECT_EQ(join_agent(), 9U) << "ids are not reused";
}

TEST_F(ParticipantsTest, EachKindHasItsOwnLimit) {
  join_agent();
  join_agent();
  const auto third = participants.join({.kind = ParticipantKind::kAgent, .name = "", .color = ""});
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().code, wire::ErrorCode::kBusy);
  EXPECT_EQ(third.error().reason, "the session is full: it admits at most 2 agents");
  EXPECT_TRUE(participants.join({.kind = ParticipantKind::kViewer, .name = "", .color = ""}));
}

TEST_F(ParticipantsTest, InvalidColorsAndToolsAreRejected) {
  for (const char* color : {"red", "#12345", "#12345g", "1234567"}) {
    const auto joined =
        participants.join({.kind = ParticipantKind::kAgent, .name = "", .color = color});
    ASSERT_FALSE(joined) << color;
    EXPECT_EQ(joined.error().code, wire::ErrorCode::kBadMessage);
  }
  const auto joined =
      participants.join({.kind = ParticipantKind::kAgent, .name = "", .color = "", .tool = 3});
  ASSERT_FALSE(joined);
  EXPECT_EQ(joined.error().code, wire::ErrorCode::kUnknownTool);
  EXPECT_TRUE(participants.list().empty());
}

TEST_F(ParticipantsTest, OnlyParticipantsThatCarveAreJournaled) {
  join_agent();
  participants.join({.kind = ParticipantKind::kViewer, .name = "Grace", .color = ""}).value();
  ASSERT_TRUE(journal.flush());
  const auto reader = JournalReader::open(file);
  ASSERT_TRUE(reader) << describe(reader.error());
  ASSERT_EQ(reader->participants().size(), 1U);
  EXPECT_EQ(reader->participants()[0].kind, "agent");
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
}  // namespace kerf
