// SPDX-License-Identifier: Apache-2.0
// Tokens stay valid for the life of a session, however many other agents join, and joins are
// limited.
#include "server/session/resumable.h"

#include "server/store/sqlite.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::resumable_test {
namespace {

class ResumableTest : public SessionTest {
 protected:
  void SetUp() override {
    limits.carver_joins_per_s = limits.carver_joins_burst = 1e9;
    SessionTest::SetUp();
    session = start();
  }
  std::expected<Admission, Rejection> admit(const std::string& token,
                                            const std::string& name = "") {
    JoinRequest request{ParticipantKind::kAgent, name, "", 1, true};
    request.durable = true;
    request.token = token;
    return session->admit(request);
  }
  /// Lets more agents join with their own tokens than are kept in memory.
  void crowd() {
    for (std::size_t n = 0; n < Resumable::kKept + 16; ++n) {
      const auto other = test::value_of(admit("", "Eve"));
      session->leave(other.participant.id);
    }
  }
  void reload() {
    session.reset();
    restart();
    ASSERT_TRUE(registry->load_all().failures.empty());
    session = registry->find("block");
    ASSERT_NE(session, nullptr);
  }

  std::shared_ptr<Session> session;
};

TEST_F(ResumableTest, TokensSurviveOtherJoinsAndARestart) {
  const auto ada = admit("", "Ada");
  const ParticipantId id = ada->participant.id;
  for (int n = 0; n < 5; ++n) move(*session, id, 0.1 * n, 0, -1);
  session->leave(id);
  crowd();
  ASSERT_TRUE(session->flush());
  auto again = admit(ada->token);
  ASSERT_TRUE(again && again->resumed);
  EXPECT_EQ(again->participant.id, id);
  EXPECT_EQ(again->participant.name, "Ada");
  EXPECT_EQ(again->agent_sequence, 5U);
  // Known samples are not cut again; new ones are.
  const auto records = session->sequence();
  sequence = 3;
  move(*session, id, 0.3, 0, -1);
  move(*session, id, 0.4, 0, -1);
  EXPECT_EQ(session->sequence(), records);
  move(*session, id, 0.5, 0, -1);
  EXPECT_EQ(session->sequence(), records + 1);
  session->leave(id);

  crowd();
  ASSERT_TRUE(session->flush());
  reload();
  again = admit(ada->token);
  ASSERT_TRUE(again && again->resumed);
  EXPECT_EQ(again->participant.id, id);
  EXPECT_EQ(again->agent_sequence, 6U);
}

TEST_F(ResumableTest, MutesSurviveOtherJoins) {
  const auto ada = admit("", "Ada");
  ASSERT_TRUE(session->people().set_muted(ada->participant.id, true));
  session->leave(ada->participant.id);
  crowd();
  const auto again = admit(ada->token);
  ASSERT_TRUE(again && again->resumed);
  EXPECT_TRUE(again->participant.is_muted);
}

TEST_F(ResumableTest, RemovedAgentStaysRemoved) {
  const auto ada = admit("", "Ada");
  ASSERT_TRUE(session->people().remove(ada->participant.id, "too loud"));
  session->leave(ada->participant.id);
  crowd();
  ASSERT_TRUE(session->flush());
  EXPECT_FALSE(admit(ada->token)->resumed);
}

TEST_F(ResumableTest, AnAgentWhoseRowIsDamagedJoinsAsANewOne) {
  const auto ada = admit("", "Ada");
  session->leave(ada->participant.id);
  crowd();
  ASSERT_TRUE(session->flush());
  auto database = test::value_of(SqlDatabase::open(session->journal_file(), SqlMode::kWrite));
  ASSERT_TRUE(database.execute("UPDATE agents SET crc=crc+1 WHERE participant=" +
                               std::to_string(ada->participant.id)));
  const auto again = test::value_of(admit(ada->token));
  EXPECT_FALSE(again.resumed);
  EXPECT_NE(again.participant.id, ada->participant.id);
}

TEST_F(ResumableTest, RecallIsRetriedUntilCommitted) {
  Resumable resumable;
  SessionJournal journal(*JournalWriter::create(folder / "other.kerf", {"other", "{}", ""}), {});
  const auto absent = [](ParticipantId) { return false; };
  const auto token = [](ParticipantId id) {
    const std::string digits = std::to_string(id);
    return std::string(32 - digits.size(), '0') + digits;
  };
  for (ParticipantId id = 1; id <= Resumable::kKept + 1; ++id) {
    ResumableAgent agent{.token = *hash_token(token(id))};
    // This state is ahead of the journal, which has no record yet.
    resumable.keep(id, agent, absent, 1);
  }
  using enum Resumable::Recall;
  EXPECT_EQ(resumable.find(1), nullptr);
  EXPECT_EQ(resumable.owner(token(1)), 1U);
  EXPECT_EQ(resumable.recall(token(1), journal, absent), kLater) << "record 1 is not committed";
  ASSERT_TRUE(journal.append(0, DefineTool{1, *make_tool(BallShape{4, 40})}));
  ASSERT_TRUE(journal.flush());
  EXPECT_EQ(resumable.recall(token(1), journal, absent), kLater) << "nor is its own row";
  journal.append({.id = 1, .kind = ParticipantKind::kAgent, .name = "Ada", .color = "#123456"},
                 hash_token(token(1)));
  ASSERT_TRUE(journal.flush());
  EXPECT_EQ(resumable.recall(token(1), journal, absent), kFound);
  ASSERT_NE(resumable.find(1), nullptr);
  EXPECT_EQ(resumable.find(1)->name, "Ada");
  EXPECT_EQ(resumable.recall(token(2), journal, absent), kLater)
      << "it has left its place to the other";
  EXPECT_EQ(resumable.owner("unknown"), std::nullopt);
}

class JoinLimits : public SessionTest {
 protected:
  std::expected<Admission, Rejection> admit(const std::string& grant,
                                            const std::string& token = "") {
    JoinRequest request{ParticipantKind::kAgent, "", "", 1, true};
    request.role = Role::kSculptor;
    request.grant = grant;
    request.invitation = grant.substr(0, grant.find('/'));  // naming scheme of these tests
    request.durable = true;
    request.token = token;
    auto admission = session->admit(request);
    if (admission) session->leave(admission->participant.id);
    return admission;
  }
  void SetUp() override {
    limits.carver_joins_per_s = limits.carver_joins_burst = 1e9;
    SessionTest::SetUp();
    session = start();
  }
  std::shared_ptr<Session> session;
};

TEST_F(JoinLimits, OneInvitationAdmitsAFullSession) {
  for (std::size_t n = 0; n < 2 * limits.agents_max; ++n) ASSERT_TRUE(admit("class")) << n;
}

TEST_F(JoinLimits, RepeatedJoinsWithOneInvitationAreLimited) {
  const auto first = admit("eve/1");
  ASSERT_TRUE(first);
  std::size_t joined = 1;
  std::expected<Admission, Rejection> last = first;
  while (last && joined < 1000) {
    last = admit("eve/" + std::to_string(joined));  // each with a pass of its own
    if (last) ++joined;
  }
  EXPECT_GE(joined, 64U);
  ASSERT_FALSE(last) << joined;
  EXPECT_EQ(last.error().code, wire::ErrorCode::kBusy);
  for (const char* part : {"64", "each 1 s", "another invitation"}) {
    EXPECT_TRUE(last.error().reason.contains(part)) << last.error().reason;
  }
  EXPECT_TRUE(admit("eve/1", first->token)->resumed) << "who comes back is no new one";
  EXPECT_TRUE(admit("ada"));
  EXPECT_TRUE(admit("")) << "an administrator";
  JoinRequest viewer{ParticipantKind::kViewer, "", "", 0, true};
  viewer.invitation = "eve";
  EXPECT_TRUE(session->join(viewer));
}

}  // namespace
}  // namespace kerf::resumable_test
