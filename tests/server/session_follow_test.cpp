// SPDX-License-Identifier: Apache-2.0
// A session that follows another one through a copy of its journal.
#include "server/history/journal_records.h"
#include "server/session/live_state.h"
#include "server/store/journal_change.h"
#include "server/threads/io_threads.h"
#include "server/threads/run_and_wait.h"
#include "tests/server/undo_fixture.h"
#include "tests/support/test.h"

namespace kerf::session_follow_test {
namespace {

class SessionFollow : public SessionUndo {
 protected:
  template <typename Work>
  auto on_follower(Work work) {
    return run_and_wait(follower_->executor(), work);
  }
  /// Copies the journal of the session in its current state and follows it.
  void follow() {
    ASSERT_TRUE(session_->flush());
    changes_.emplace(session_->journal_file());
    auto copy = test::value_of(JournalCopy::create(copied_));
    pass_on(copy);
    const auto position = test::value_of(copy.finish());
    copy_ = JournalCopy::resume(copied_, position).value();
    auto followed = test::value_of(servers_.follow("block"));
    follower_ = followed;
  }
  void pass_on(JournalCopy& copy) {
    for (auto change = changes_->next(); *change; change = changes_->next()) {
      ASSERT_TRUE(copy.apply(**change));
    }
  }
  /// Passes on the session's committed records. Returns the result of following them.
  std::expected<void, std::string> pass_on() {
    EXPECT_TRUE(session_->flush());
    pass_on(*copy_);
    std::vector<JournalRecord> records;
    const RecordRange range{on_follower([&] { return follower_->sequence(); }) + 1,
                            copy_->whole()->record};
    if (range.first <= range.last) {
      EXPECT_TRUE(journal_records(copied_)->read(
          {&range, 1}, [&](JournalRecord& record) { records.push_back(record); }, {}));
    }
    for (std::span<const JournalRecord> rest(records); !rest.empty();) {
      const auto done = on_follower([&] { return follower_->follow(rest); });
      if (!done) return std::unexpected(done.error());
      rest = rest.subspan(*done);
    }
    return {};
  }
  /// Returns the hash of the follower's block once undone strokes have been removed.
  std::uint64_t followers_hash() {
    while (on_follower([&] { return follower_->is_between_records(); })) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return on_follower([&] { return follower_->solid().hash(); });
  }
  void TearDown() override {
    if (follower_) servers_.end_following("block", "the test ends");
  }

  const test::TemporaryFolder there_;
  const std::filesystem::path copied_ = there_ / "block.kerf";
  IoThreads behind_{"behind", 1, 0};
  SessionRegistry servers_{
      RegistryOptions{there_.path(), 4, limits_, {}, snapshots_},
      [](const std::string& id) { return std::make_shared<IoThreads>(id, 1, 0); }, behind_};
  std::optional<JournalChanges> changes_;
  std::optional<JournalCopy> copy_;
  std::shared_ptr<Session> follower_;
};

TEST_F(SessionFollow, BlockEqualsTheOwnersThroughRandomCutsUndoAndRedo) {
  std::mt19937 chance(20);
  const test::Uniform pick(chance);
  create();
  const ParticipantId hands[] = {join("Ada"), join("Bo")};
  std::vector<StrokeId> done, undone;
  stroke(hands[0], {-10, 0, -2}, {10, 0, -2});
  follow();
  for (int n = 0; n < 60; ++n) {
    const double kind = pick(0, 1);
    if (kind < 0.6 || done.empty()) {
      const Vec3 from{pick(-20, 20), pick(-20, 20), pick(-8, 1)};
      done.push_back(stroke(hands[n % 2], from, {pick(-20, 20), pick(-20, 20), pick(-8, 1)}));
    } else if (kind < 0.85 || undone.empty()) {
      std::swap(done[chance() % done.size()], done.back());
      undo({done.back()});
      undone.push_back(done.back());
      done.pop_back();
    } else {
      redo({undone.back()});
      done.push_back(undone.back());
      undone.pop_back();
    }
    if (n % 3 != 0) continue;  // several changes at once
    const auto passed = pass_on();
    ASSERT_TRUE(passed) << passed.error();
    if (n % 2 == 0) {
      ASSERT_EQ(followers_hash(), hash()) << n;
    }
  }
  ASSERT_TRUE(pass_on());
  EXPECT_EQ(followers_hash(), hash());
  EXPECT_EQ(followers_hash(), never_happened());
  EXPECT_EQ(on_follower([&] { return follower_->sequence(); }), session_->sequence());
}

TEST_F(SessionFollow, StrokeChangedDuringItsUndoEndsAsOwnerLeftIt) {
  create();
  const ParticipantId ada = join("Ada");
  const StrokeId under = stroke(ada, {-15, 0, -2}, {15, 0, -2}, 1500);
  follow();
  for (int n = 0; n < 12; ++n) {
    undo({under});
    ASSERT_TRUE(pass_on());
    redo({under});
    ASSERT_TRUE(pass_on());
    EXPECT_EQ(followers_hash(), hash()) << n;
  }
}

// The tiles of the stroke are carved again from the records and replaced. Cuts made in the meantime
// are not among these records.
TEST_F(SessionFollow, CutsDuringAnUndoStayInTheBlock) {
  create();
  const ParticipantId ada = join("Ada"), bo = join("Bo");
  const StrokeId under = stroke(bo, {-15, 0, -2}, {15, 0, -2}, 1500);
  follow();
  int meanwhile = 0;
  for (int round = 0; round < 6; ++round) {
    if (round % 2 == 0) undo({under});
    if (round % 2 == 1) redo({under});
    ASSERT_TRUE(pass_on());
    for (int n = 0; n < 20; ++n) {
      const bool is_settling = on_follower([&] { return follower_->is_between_records(); });
      meanwhile += is_settling ? 1 : 0;
      const double x = -14 + 1.4 * n, depth = -3 - 0.5 * round;
      stroke(ada, {x, -1, depth}, {x, 1, depth}, 2);
      ASSERT_TRUE(pass_on());
    }
    ASSERT_EQ(followers_hash(), hash()) << round;
  }
  EXPECT_GT(meanwhile, 0) << "the strokes are taken out too soon: make the stroke longer";
}

TEST_F(SessionFollow, JournalCanBeContinuedByAServer) {
  create();
  const ParticipantId ada = join("Ada");
  const StrokeId first = stroke(ada, {-10, 0, -2}, {10, 0, -2});
  follow();
  stroke(ada, {-10, 5, -4}, {10, 5, -4});
  undo({first});
  ASSERT_TRUE(pass_on());
  const std::uint64_t expected = followers_hash();
  copy_.reset();
  servers_.end_following("block", "it goes on here");
  follower_.reset();
  EXPECT_TRUE(JournalChanges(copied_).begin(changes_->position()).value_or(false));
  LoadReport report;
  servers_.expect("block");
  servers_.open("block", report);
  EXPECT_TRUE(report.failures.empty());
  const auto opened = servers_.find("block");
  ASSERT_TRUE(opened);
  EXPECT_EQ(run_and_wait(opened->executor(), [&] { return opened->solid().hash(); }), expected);
  EXPECT_FALSE(opened->is_followed());
}

TEST_F(SessionFollow, OnlyTheOwnersRecordsChangeIt) {
  create();
  const ParticipantId ada = join("Ada");
  stroke(ada, {-10, 0, -2}, {10, 0, -2});
  follow();
  const auto before = followers_hash();
  const auto answer = on_follower([&] {
    const auto joined = follower_->join({ParticipantKind::kAgent, "Eve", "", 1, true});
    EXPECT_TRUE(joined);
    EXPECT_GT(joined->id, kFollowerIds);
    wire::MotionSample samples[2] = {next(joined->id, {0, 0, -1}, true),
                                     next(joined->id, {1, 0, -1}, true)};
    return follower_->move(joined->id, samples);
  });
  ASSERT_FALSE(answer.rejections.empty());
  EXPECT_EQ(answer.rejections.front().code, wire::ErrorCode::kNotAllowed);
  SerialWorkers alone;
  const auto error = test::error_of(follower_->stroke_changes().change(
      {.undone = true, .participant = ada, .caller = Caller::local()}, alone));
  EXPECT_EQ(error.code, wire::ErrorCode::kNotAllowed);
  EXPECT_EQ(followers_hash(), before);
  EXPECT_EQ(before, hash());
}

TEST_F(SessionFollow, DifferenceFromTheOwnerIsDetected) {
  create();
  const ParticipantId ada = join("Ada");
  stroke(ada, {-10, 0, -2}, {10, 0, -2});
  follow();
  const std::uint64_t last = session_->sequence();
  const std::uint64_t own = followers_hash();
  const auto compare = [&](StateHash owners) {
    return on_follower([&] { return follower_->compare_hash(owners); });
  };
  EXPECT_TRUE(compare({last, own}).value_or(false));
  EXPECT_FALSE(compare({last - 1, own + 1}).value_or(true)) << "of another solid";
  const auto error = test::error_of(compare({last, own + 1}));
  EXPECT_NE(error.find("at its owner"), std::string::npos) << error;
}

TEST_F(SessionFollow, ViewersSeeTheOwnersParticipants) {
  create();
  const ParticipantId ada = join("Ada");
  stroke(ada, {-10, 0, -2}, {10, 0, -2});
  follow();
  session_->note_viewers_elsewhere(3);
  EXPECT_EQ(session_->roster().viewers, 3U);
  LiveState stated = session_->live_state();
  stated.paused = "disk";
  stated.viewers = {{"b", 3}, {"c", 2}};
  ProgramGlance program{
      .id = 4, .name = "s.ngc", .state = ProgramState::kPaused, .error = "line 3"};
  stated.programs = {program};
  const auto bytes = encode_live(stated);
  auto read = test::value_of(decode_live(bytes));
  EXPECT_EQ(read.tools, stated.tools);
  EXPECT_EQ(read.viewers, stated.viewers);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode_live(std::span(bytes).first(size))) << size;
  }
  const auto frame = on_follower([&] {
    follower_->follow_live(read, 2);
    return follower_->frame(false);
  });
  EXPECT_EQ(frame.tools, stated.tools);
  ASSERT_EQ(frame.tools.tools.size(), 1U);
  EXPECT_EQ(frame.paused, "disk");
  ASSERT_TRUE(frame.programs);
  EXPECT_EQ(frame.programs->front().name, "s.ngc");
  EXPECT_EQ(frame.programs->front().state, ProgramState::kPaused);
  const Roster roster = on_follower([&] { return follower_->roster(); });
  ASSERT_EQ(roster.listed.size(), 1U);
  EXPECT_EQ(roster.listed.front().name, "Ada");
  EXPECT_EQ(roster.viewers, 2U);
}

}  // namespace
}  // namespace kerf::session_follow_test
