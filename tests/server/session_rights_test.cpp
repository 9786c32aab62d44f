// SPDX-License-Identifier: Apache-2.0
// Effects of roles, mutes, removals and reserved regions on the participants of a session.
#include "kernel/tool/tool_bounds.h"
#include "server/http/api.h"
#include "server/session/reserved.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::session_rights_test {
namespace {

using wire::ErrorCode;

class SessionRightsTest : public SessionTest {
 protected:
  void SetUp() override {
    SessionTest::SetUp();
    session = start();
  }
  std::expected<Participant, Rejection> join_as(Role role, const std::string& grant = "",
                                                ParticipantKind kind = ParticipantKind::kAgent) {
    JoinRequest request{kind, "Ada", "", 0, true};
    request.role = role;
    request.grant = grant;
    request.is_personal = !grant.empty();
    return session->join(request);
  }
  /// Returns the code of the only rejection of a motion from the newest pose to this one.
  std::optional<ErrorCode> cut_to(ParticipantId id, double x, double y, double z) {
    const MotionAnswer answer = move(*session, id, x, y, z);
    if (answer.rejections.empty()) return std::nullopt;
    return answer.rejections.front().code;
  }

  std::shared_ptr<Session> session;
};

TEST_F(SessionRightsTest, WatchersCannotCut) {
  EXPECT_EQ(join_as(Role::kWatcher).error().code, ErrorCode::kNotAllowed);
  EXPECT_EQ(join_as(Role::kNobody, "", ParticipantKind::kViewer).error().code,
            ErrorCode::kNotAllowed);
  EXPECT_TRUE(join_as(Role::kWatcher, "", ParticipantKind::kViewer));
  EXPECT_EQ(join_as(Role::kGuest, "", ParticipantKind::kProgram).error().code,
            ErrorCode::kNotAllowed);
  EXPECT_TRUE(join_as(Role::kSculptor));
}

TEST_F(SessionRightsTest, AMutedParticipantCutsNothingUntilUnmuted) {
  const ParticipantId id = join_as(Role::kSculptor, "pass")->id;
  cut_to(id, 0, 0, -1);
  EXPECT_EQ(cut_to(id, 1, 0, -1), std::nullopt);
  const auto records = session->sequence();
  ASSERT_TRUE(session->people().set_muted(id, true));
  EXPECT_EQ(cut_to(id, 2, 0, -1), ErrorCode::kMuted);
  EXPECT_EQ(cut_to(id, 6, 0, -1), ErrorCode::kMuted);
  EXPECT_EQ(session->sequence(), records);
  EXPECT_TRUE(session->roster().listed.front().is_muted);
  ASSERT_TRUE(session->people().set_muted(id, false));
  const double before = session->info().removed_mm3;
  EXPECT_EQ(cut_to(id, 6.01, 0, -1), std::nullopt);
  // The motion begins at the muted tool's pose: its earlier path is not cut.
  EXPECT_LT(session->info().removed_mm3 - before, 17);
  EXPECT_FALSE(session->people().set_muted(99, true));
}

TEST_F(SessionRightsTest, MuteAppliesToThePersonAndAfterResuming) {
  JoinRequest request{ParticipantKind::kAgent, "Ada", "", 0, true};
  request.durable = true;
  const auto admission = test::value_of(session->admit(request));
  const auto one = join_as(Role::kSculptor, "pass"), other = join_as(Role::kSculptor, "pass");
  ASSERT_TRUE(session->people().set_muted(one->id, true));
  EXPECT_TRUE(session->people().participant(other->id)->is_muted);
  EXPECT_FALSE(session->people().participant(admission.participant.id)->is_muted);
  ASSERT_TRUE(session->people().set_muted(admission.participant.id, true));
  session->leave(admission.participant.id);
  request.token = admission.token;
  const auto again = session->admit(request);
  ASSERT_TRUE(again && again->resumed);
  EXPECT_TRUE(again->participant.is_muted);
}

TEST_F(SessionRightsTest, ARemovedAgentCannotResume) {
  JoinRequest request{ParticipantKind::kAgent, "Ada", "", 0, true};
  request.durable = true;
  const auto admission = test::value_of(session->admit(request));
  SessionEvent seen;
  session->listen([&](const SessionEvent& event) { seen = event; });
  ASSERT_TRUE(session->people().remove(admission.participant.id, "too loud"));
  EXPECT_EQ(seen.removed, admission.participant.id);
  EXPECT_EQ(seen.closing, "too loud");
  session->leave(admission.participant.id);
  request.token = admission.token;
  EXPECT_FALSE(test::value_of(session->admit(request)).resumed);
  EXPECT_FALSE(session->people().remove(99, ""));
}

TEST_F(SessionRightsTest, ARemovedAgentCannotResumeAfterARestart) {
  JoinRequest ada{ParticipantKind::kAgent, "Ada", "", 0, true};
  ada.durable = true;
  JoinRequest grace = ada;
  ada.token = session->admit(ada)->token;
  const auto admitted = session->admit(grace);
  grace.token = admitted->token;
  ASSERT_TRUE(session->people().remove(admitted->participant.id, "too loud"));
  ASSERT_TRUE(session->flush());
  session.reset();
  restart();
  ASSERT_EQ(registry->load_all().failures.size(), 0U);
  session = registry->find("block");
  EXPECT_TRUE(session->admit(ada)->resumed);
  EXPECT_FALSE(session->admit(grace)->resumed);
}

TEST_F(SessionRightsTest, OneNetworkOfGuestsCannotExcludeAnother) {
  JoinRequest guest{ParticipantKind::kAgent, "Eve", "", 0, true};
  guest.role = Role::kGuest;
  guest.network = "10.0.0.1";
  for (int n = 0; n < 4; ++n) ASSERT_TRUE(session->join(guest)) << n;
  EXPECT_EQ(session->join(guest).error().code, ErrorCode::kBusy);
  JoinRequest viewer = guest;
  viewer.kind = ParticipantKind::kViewer;
  EXPECT_TRUE(session->join(viewer));
  guest.network = "10.0.0.2";
  EXPECT_TRUE(session->join(guest));
}

TEST_F(SessionRightsTest, NewestOfTwoRegionChangesWins) {
  net::HttpOptions options{.data_folder = folder.path()};
  const net::Metrics metrics;
  const auto access = *Access::open({});
  net::Api api(options, *registry, metrics, *access);
  ASSERT_TRUE(access->reserve("block", {.min_mm = {5, -20, -20}, .max_mm = {20, 20, 10}}));
  api.tell_regions(*session);
  // Another request, which posted to the session before the one above.
  ASSERT_TRUE(access->release("block", 1));
  executor->run();
  const ParticipantId id = join_as(Role::kSculptor)->id;
  cut_to(id, 6, 0, -1);
  EXPECT_EQ(cut_to(id, 7, 0, -1), std::nullopt);
}

TEST_F(SessionRightsTest, AConnectionOpenedBeforeADecisionJoinsAsDecided) {
  session->remove_holders(std::vector<std::string>{"ended"}, "the invitation was revoked");
  EXPECT_EQ(join_as(Role::kSculptor, "ended").error().code, ErrorCode::kNotAllowed);
  EXPECT_EQ(join_as(Role::kSculptor, "ended", ParticipantKind::kViewer).error().code,
            ErrorCode::kNotAllowed);
  session->people().set_role_of("lowered", Role::kWatcher);
  EXPECT_EQ(join_as(Role::kSculptor, "lowered").error().code, ErrorCode::kNotAllowed);
  session->people().set_muted_of("muted", true);
  EXPECT_TRUE(join_as(Role::kSculptor, "muted")->is_muted);
  session->people().set_muted_of("muted", false);
  EXPECT_FALSE(join_as(Role::kSculptor, "muted")->is_muted);
  EXPECT_TRUE(join_as(Role::kSculptor, "other"));
}

TEST_F(SessionRightsTest, ProgramsEndWithTheGrantOfTheirAuthor) {
  Program program{.name = "p.ngc"};
  for (int n = 0; n < 1000; ++n) {
    program.motions.push_back({1, {{0, 0, -1}, {0, 0, 1}}, {{1, 0, -1}, {0, 0, 1}}, 1});
  }
  Caller ada{.role = Role::kSculptor};
  ada.grant = "ada";
  const auto started = session->programs().start(program, {ProgramPace::kFeed}, ada);
  ada.grant = "ben";
  const auto other = session->programs().start(program, {ProgramPace::kFeed}, ada);
  ASSERT_TRUE(started && other);
  session->remove_holders(std::vector<std::string>{"ada"}, "the invitation was revoked");
  EXPECT_EQ(session->programs().status(started->id)->state, ProgramState::kCancelled);
  EXPECT_EQ(session->programs().status(other->id)->state, ProgramState::kRunning);
}

TEST_F(SessionRightsTest, DemotedSculptorStopsCutting) {
  const ParticipantId id = join_as(Role::kSculptor, "pass")->id;
  cut_to(id, 0, 0, -1);
  session->people().set_role_of("pass", Role::kWatcher);
  EXPECT_EQ(cut_to(id, 1, 0, -1), ErrorCode::kNotAllowed);
  session->people().set_role_of("pass", Role::kOwner);
  EXPECT_EQ(cut_to(id, 2, 0, -1), std::nullopt);
  EXPECT_EQ(session->people().participant(id)->role, Role::kOwner);
}

TEST_F(SessionRightsTest, GuestsAreLimitedInNumberAndSpeed) {
  std::vector<ParticipantId> guests;
  for (std::size_t n = 0; n < limits.guest_agents_max; ++n) {
    const auto guest = test::value_of(join_as(Role::kGuest));
    guests.push_back(guest.id);
  }
  EXPECT_EQ(join_as(Role::kGuest).error().code, ErrorCode::kBusy);
  EXPECT_TRUE(join_as(Role::kGuest, "", ParticipantKind::kViewer));
  const ParticipantId sculptor = join_as(Role::kSculptor)->id;
  // 1 mm in 1 ms exceeds the speed limit of a guest but not of a sculptor.
  cut_to(guests[0], 0, 0, -1);
  EXPECT_EQ(cut_to(guests[0], 1, 0, -1), ErrorCode::kTooFast);
  EXPECT_EQ(cut_to(guests[0], 1.4, 0, -1), std::nullopt);
  cut_to(sculptor, 0, 5, -1);
  EXPECT_EQ(cut_to(sculptor, 1, 5, -1), std::nullopt);
  // A guest that joins and leaves repeatedly must wait.
  for (const ParticipantId guest : guests) session->leave(guest);
  EXPECT_EQ(join_as(Role::kGuest).error().code, ErrorCode::kBusy);
}

TEST_F(SessionRightsTest, OnlyItsParticipantAndOwnersCutInAReservedRegion) {
  const ParticipantId ada = join_as(Role::kSculptor)->id;
  const ParticipantId grace = join_as(Role::kSculptor, "pass")->id;
  const ParticipantId owner = join_as(Role::kOwner)->id;
  session->reserve(
      {{1, {5, -20, -20}, {20, 20, 10}, ada, ""}, {2, {-20, -20, -20}, {-12, 20, 0}, 0, "pass"}});
  for (const ParticipantId id : {ada, grace, owner}) cut_to(id, -5, 0, -1);
  // The ball has a radius of 5 mm: at x = 0.2 it reaches into the region.
  const auto records = session->sequence();
  EXPECT_EQ(cut_to(grace, 0.2, 0, -1), ErrorCode::kReserved);
  EXPECT_EQ(session->sequence(), records);
  EXPECT_EQ(cut_to(ada, 0.2, 0, -1), std::nullopt);
  EXPECT_EQ(cut_to(owner, 0.2, 0, -1), std::nullopt);
  // Above the stock there is nothing to cut.
  cut_to(grace, -4, 0, 20);
  EXPECT_EQ(cut_to(grace, 0.2, 0, 20), std::nullopt);
  // The second region belongs to a person, whatever the participant's number.
  cut_to(ada, -5, 0, -1);
  EXPECT_EQ(cut_to(ada, -9.5, 0, -1), ErrorCode::kReserved);
  cut_to(grace, -5, 0, -1);
  EXPECT_EQ(cut_to(grace, -9.5, 0, -1), std::nullopt);
  session->reserve({});
  EXPECT_EQ(cut_to(grace, -5, 0, -1), std::nullopt);
}

// A rejected motion leaves no trace: a replay gives the session's block.
TEST_F(SessionRightsTest, ReplayDoesNotDependOnRegions) {
  const ParticipantId id = join_as(Role::kSculptor)->id;
  session->reserve({{1, {0, -20, -20}, {20, 20, 0}, 0, ""}});
  for (int n = 0; n < 40; ++n) cut_to(id, -15 + 0.5 * n, 0, -1);
  const std::uint64_t hash = session->solid().hash();
  const double removed = session->info().removed_mm3;
  ASSERT_TRUE(session->flush());
  session.reset();
  restart();
  registry->load_all();
  session = registry->find("block");
  ASSERT_NE(session, nullptr);
  EXPECT_EQ(session->solid().hash(), hash);
  EXPECT_EQ(session->info().removed_mm3, removed);
}

// At every sampled pose between the ends, the tool's own box must be inside the bounds.
TEST(SweptBounds, ContainTheToolAtEveryPoseOfAMotion) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto direction = [&] {
    Vec3 axis{any(random), any(random), any(random)};
    while (length(axis) < 0.1) axis = {any(random), any(random), any(random)};
    return axis * (1 / length(axis));
  };
  Tool tool;
  tool.length_mm = tool.whole_length_mm = 60;
  tool.radius_mm = tool.whole_radius_mm = 5;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 a = direction(), b = direction();
    const double angle = std::acos(std::clamp(dot(a, b), -1.0, 1.0));
    if (angle > 2.9) continue;
    MoveTool move;
    move.from = {{20 * any(random), 20 * any(random), 20 * any(random)}, a};
    move.to = {{20 * any(random), 20 * any(random), 20 * any(random)}, b};
    const Bounds bounds = swept_bounds(move, tool, 1e-9);
    for (int step = 0; step <= 20; ++step) {
      const double share = step / 20.0;
      const Vec3 axis = angle < 1e-6
                            ? a
                            : (a * std::sin((1 - share) * angle) + b * std::sin(share * angle)) *
                                  (1 / std::sin(angle));
      const Vec3 tip = move.from.tip_mm + (move.to.tip_mm - move.from.tip_mm) * share;
      const Bounds at = tool_bounds(tool, {tip, axis});
      for (const auto coordinate : {&Vec3::x, &Vec3::y, &Vec3::z}) {
        EXPECT_GE(at.lo_mm.*coordinate, bounds.lo_mm.*coordinate);
        EXPECT_LE(at.hi_mm.*coordinate, bounds.hi_mm.*coordinate);
      }
    }
  }
}

}  // namespace
}  // namespace kerf::session_rights_test
