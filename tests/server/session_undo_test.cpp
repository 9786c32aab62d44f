// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/workers.h"
#include "server/formats/program.h"
#include "server/session/journal_check.h"
#include "server/session/session_export.h"
#include "tests/server/undo_fixture.h"
#include "tests/support/test.h"

namespace kerf::session_undo_test {
namespace {

TEST_F(SessionUndo, LeavesTheBlockWithoutTheStroke) {
  create();
  const ParticipantId ada = join("Ada"), bo = join("Bo");
  stroke(ada, {-15, 0, -2}, {15, 0, -2});
  const double before_mm3 = session_->info().removed_mm3;
  const std::uint64_t before = hash();
  const StrokeId second = stroke(bo, {0, -15, -3}, {0, 15, -3});
  const double after_mm3 = session_->info().removed_mm3;
  const std::uint64_t after = hash();
  const StrokesChanged undone = undo({second});
  EXPECT_EQ(hash(), before);
  EXPECT_NEAR(undone.returned_mm3, after_mm3 - before_mm3, 1e-6);
  EXPECT_NEAR(session_->info().removed_mm3, before_mm3, 1e-6);
  EXPECT_FALSE(session_->is_between_records());
  EXPECT_FALSE(session_->frame(false).changed.empty());
  const StrokesChanged redone = redo({second});
  EXPECT_EQ(hash(), after);
  EXPECT_NEAR(redone.returned_mm3, before_mm3 - after_mm3, 1e-6);
}

TEST_F(SessionUndo, TheNewestStrokeOfAParticipantComesFirst) {
  create();
  const ParticipantId ada = join("Ada"), bo = join("Bo");
  const StrokeId a1 = stroke(ada, {-15, 0, -2}, {15, 0, -2});
  const StrokeId b1 = stroke(bo, {0, -15, -3}, {0, 15, -3});
  const StrokeId a2 = stroke(ada, {-15, 8, -2}, {15, 8, -2});
  const auto step = [&](bool undone, ParticipantId who) {
    return change({.undone = undone, .participant = who, .author = who})->strokes;
  };
  EXPECT_EQ(step(true, ada), std::vector{a2});
  EXPECT_EQ(step(true, ada), std::vector{a1});
  EXPECT_FALSE(change({.undone = true, .participant = ada, .author = ada}));
  EXPECT_EQ(step(false, ada), std::vector{a1});
  EXPECT_EQ(step(false, ada), std::vector{a2});
  EXPECT_EQ(step(true, bo), std::vector{b1});
  EXPECT_EQ(hash(), never_happened());
}

TEST_F(SessionUndo, NewestStrokeIsThatAtTheRequest) {
  create();
  const ParticipantId ada = join("Ada"), bo = join("Bo");
  const StrokeId a = stroke(ada, {-15, 0, -2}, {15, 0, -2});
  const StrokeId b = stroke(bo, {0, -15, -3}, {0, 15, -3});
  executor_->run();
  const auto ask = [this](StrokeRequest request) {
    request.caller = Caller::local();
    return std::async(std::launch::async, [this, request] {
      SerialWorkers alone;
      return session_->stroke_changes().change(request, alone);
    });
  };
  const auto wait_for_turns = [this](std::size_t count) {
    for (int n = 0; n < 1000 && executor_->waiting() < count; ++n) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  auto first = ask({.undone = true, .strokes = {b}});
  wait_for_turns(1);
  executor_->run();
  wait_for_turns(1);  // it has the history until it gets this turn
  auto newest = ask({.undone = true, .participant = ada});
  wait_for_turns(2);
  executor_->run();
  stroke(ada, {-15, 8, -2}, {15, 8, -2});
  for (const auto* answer : {&first, &newest}) {
    while (answer->wait_for(std::chrono::microseconds(200)) != std::future_status::ready) {
      executor_->run();
    }
  }
  EXPECT_EQ(test::value_of(newest.get()).strokes, std::vector{a});
  executor_->run();
  EXPECT_EQ(hash(), never_happened());
}

TEST_F(SessionUndo, ParticipantsCarveDuringAnUndo) {
  create();
  const ParticipantId ada = join("Ada"), bo = join("Bo");
  std::vector<StrokeId> strokes;
  for (int n = 0; n < 12; ++n) {
    strokes.push_back(stroke(ada, {-15, n - 6.0, -3}, {15, n - 6.0, -3}, 60));
  }
  double angle = 0;
  int motions = 0;
  move(bo, {10, 0, 1}, false);
  for (const StrokeId id : strokes) {
    const auto done = change({.undone = true, .strokes = {id}}, [&] {
      if (motions > 400) return;  // the limit of samples per second
      angle += 0.05;
      ++motions;
      const auto answer = move(bo, {10 * std::cos(angle), 10 * std::sin(angle), -2});
      for (const Rejection& rejection : answer.rejections) {
        ASSERT_EQ(rejection.code, wire::ErrorCode::kInStock);
        move(bo, {10 * std::cos(angle), 10 * std::sin(angle), 1}, false);
      }
    });
    ASSERT_TRUE(done);
    ASSERT_EQ(hash(), never_happened());
  }
  EXPECT_GT(motions, 20);
}

TEST_F(SessionUndo, AnUndoneStrokeIsNotContinued) {
  create();
  const ParticipantId ada = join("Ada");
  move(ada, {-10, 0, 1}, false);
  move(ada, {-10, 0, -1});
  const StrokeId first = session_->sequence();
  for (int n = 0; n < 10; ++n) move(ada, {-10.0 + n, 0, -1});
  undo({first});
  EXPECT_EQ(hash(), never_happened());
  // Ada's tool is inside returned stock: it cuts nothing until it is clear.
  const auto held = move(ada, {1, 0, -1});
  ASSERT_EQ(held.rejections.size(), 1U);
  EXPECT_EQ(held.rejections.front().code, wire::ErrorCode::kInStock);
  EXPECT_EQ(held.result.removed_mm3, 0);
  // Lifting the tool cuts nothing either.
  const std::uint64_t records = session_->sequence();
  time_ms_ += 20;
  EXPECT_TRUE(move(ada, {1, 0, 2}).rejections.empty());
  EXPECT_EQ(session_->sequence(), records);
  const auto again = move(ada, {1, 0, -1});
  EXPECT_TRUE(again.rejections.empty());
  EXPECT_GT(again.result.removed_mm3, 0);
  EXPECT_EQ(hash(), never_happened());
  EXPECT_NE(hash(), Sculpture::create(session_->scene()->settings)->state_hash());
}

TEST_F(SessionUndo, ToolElsewhereContinuesToCut) {
  create();
  const ParticipantId ada = join("Ada"), bo = join("Bo");
  const StrokeId a = stroke(ada, {10, 10, -3}, {16, 16, -3});
  move(bo, {-15, -15, 1}, false);
  for (int n = 0; n < 10; ++n) move(bo, {-15.0 + 0.5 * n, -15, -3});
  undo({a});
  const auto answer = move(bo, {-9.5, -15, -3});
  EXPECT_TRUE(answer.rejections.empty());
  EXPECT_GT(answer.result.removed_mm3, 0);
  EXPECT_EQ(hash(), never_happened());
}

TEST_F(SessionUndo, MotionInPiecesIsCompletedBeforeItsUndo) {
  std::string scene = kScene;
  scene.replace(scene.find("\"pitch_mm\": 0.5"), 15, "\"pitch_mm\": 0.05");
  create(scene);
  const ParticipantId ada = join("Ada");
  move(ada, {-18, -18, 1}, false);
  wire::MotionSample sample{.agent_sequence = ++sequences_[ada]};
  time_ms_ += 1000;
  sample.time_us = 1000 * time_ms_;
  sample.tip_mm = {18, 18, -2};
  sample.tool_id = 1;
  sample.buttons = wire::kButtonCutting;
  ASSERT_FALSE(session_->begin_move(ada, {&sample, 1}));
  const StrokeId in_pieces = session_->sequence();
  int turns = 0;
  bool answered = false;
  const auto done = change({.undone = true, .strokes = {in_pieces}}, [&] {
    // Late enough: without the wait, the tiles would have been replaced by then.
    if (++turns > 400 && !answered) answered = session_->go_on(ada).has_value();
  });
  ASSERT_TRUE(done) << done.error().reason;
  while (!answered) answered = session_->go_on(ada).has_value();
  EXPECT_FALSE(session_->is_between_records());
  EXPECT_EQ(hash(), never_happened());
}

/// An agent that may resume, in the middle of a stroke of five motions, which is undone.
class ResumedUndo : public SessionUndo {
 protected:
  void SetUp() override {
    SessionUndo::SetUp();
    create();
    request_.durable = true;
    const auto admitted = test::value_of(session_->admit(request_));
    ada_ = admitted.participant.id;
    request_.token = admitted.token;
    move(ada_, {-10, 0, 1}, false);
    for (int n = 0; n < 5; ++n) move(ada_, {-10.0 + n, 0, -1});
    EXPECT_TRUE(session_->flush());
    undo({session_->sequence() - 4});
  }

  JoinRequest request_{ParticipantKind::kAgent, "Ada", "", 1, true};
  ParticipantId ada_ = 0;
};

TEST_F(ResumedUndo, ResumingAfterARestartBeginsAStroke) {
  EXPECT_EQ(hash(), never_happened());
  reload();
  const auto resumed = test::value_of(session_->admit(request_));
  ASSERT_TRUE(resumed.resumed);
  // A sample that the session already has places the tool, so that the next motion begins there.
  --sequences_[ada_];
  move(ada_, {-6, 0, -1});
  for (int n = 0; n < 5; ++n) move(ada_, {-5.0 + n, 0, -1});
  EXPECT_EQ(hash(), never_happened());
}

TEST_F(ResumedUndo, ReconnectingDoesNotFreeATool) {
  const std::uint64_t records = session_->sequence();
  ASSERT_TRUE(session_->admit(request_));
  EXPECT_FALSE(move(ada_, {-5, 0, -1}).rejections.empty());
  EXPECT_EQ(session_->sequence(), records);
}

TEST_F(SessionUndo, ARestartGivesTheSameBlock) {
  create();
  const ParticipantId ada = join("Ada"), bo = join("Bo");
  const StrokeId a = stroke(ada, {-15, 0, -2}, {15, 0, -2});
  const StrokeId b = stroke(bo, {0, -15, -3}, {0, 15, -3});
  undo({a});
  executor_->run(true);  // the hash after it
  workers_.run();
  executor_->run();
  stroke(ada, {-15, 8, -2}, {15, 8, -2});
  undo({b});
  const std::uint64_t expected = hash();
  reload();
  EXPECT_EQ(hash(), expected);
  redo({a});
  EXPECT_EQ(hash(), never_happened());
  EXPECT_TRUE(session_->flush());
  const auto verified = test::value_of(verify_journal(session_->journal_file()));
  EXPECT_EQ(verified.difference, "");
  EXPECT_EQ(verified.hash, hash());
  EXPECT_GT(verified.hashes_compared, 0U);
}

TEST_F(SessionUndo, PastEqualsTheBlockAfterARecordToTheBit) {
  create();
  const ParticipantId ada = join("Ada"), bo = join("Bo");
  std::map<std::uint64_t, std::uint64_t> hashes = {{0, hash()}};
  const auto note = [&] { hashes[session_->sequence()] = hash(); };
  const StrokeId a = stroke(ada, {-15, 0, -2}, {15, 0, -2});
  note();
  const StrokeId b = stroke(bo, {0, -15, -3}, {0, 15, -3});
  note();
  undo({a});
  note();
  stroke(ada, {-15, 8, -2}, {15, 8, -2});
  note();
  redo({a});
  undo({b});
  note();
  test::ThreadWorkers two(2);
  for (int round = 0; round < 2; ++round) {
    for (const auto& [record, expected] : hashes) {
      const auto then = session_->past().solid_at(record, two);
      ASSERT_TRUE(then && *then) << record;
      EXPECT_EQ((*then)->hash(), expected) << "after record " << record;
    }
    reload();
  }
  const auto later = session_->past().solid_at(session_->sequence() + 1, two);
  EXPECT_TRUE(later && !*later);
}

TEST_F(SessionUndo, ExportsLeaveUndoneStrokesOut) {
  create();
  const ParticipantId ada = join("Ada"), bo = join("Bo");
  stroke(ada, {-15, 0, -2}, {15, 0, -2});
  const StrokeId b = stroke(bo, {0, -15, -3}, {0, 15, -3});
  stroke(ada, {-15, 8, -2}, {15, 8, -2});
  undo({b});
  ASSERT_TRUE(session_->flush());
  std::ostringstream text, forces;
  ASSERT_TRUE(export_program(session_->journal_file(), {}, text));
  const auto program = test::value_of(parse_program("export.ngc", text.str(), *session_->scene()));
  Sculpture block = Sculpture::create(session_->scene()->settings).value();
  for (const auto& [id, tool] : session_->scene()->tools) {
    block.apply(DefineTool{id, tool.tool}).value();
  }
  for (const ProgramMotion& motion : program.motions) {
    block.apply(MoveTool{motion.tool, motion.from, motion.to, motion.duration_s, false}).value();
  }
  EXPECT_EQ(block.state_hash(), hash());
  ASSERT_TRUE(export_forces(session_->journal_file(), {}, forces));
  EXPECT_EQ(std::ranges::count(forces.str(), '\n'), 1 + 40);
}

TEST_F(SessionUndo, InvalidOrForbiddenRequestsChangeNothing) {
  create();
  const ParticipantId ada = join("Ada"), bo = join("Bo");
  const StrokeId a = stroke(ada, {-15, 0, -2}, {15, 0, -2});
  const StrokeId b = stroke(bo, {0, -15, -3}, {0, 15, -3});
  const std::uint64_t before = hash(), records = session_->sequence();
  using enum wire::ErrorCode;
  const auto code = [&](StrokeRequest request) {
    const auto done = change(std::move(request));
    return done ? std::nullopt : std::optional(done.error().code);
  };
  EXPECT_EQ(code({.undone = true, .strokes = {a + 1}}), kBadMessage);
  EXPECT_EQ(code({.undone = true, .strokes = {a, 9999}}), kBadMessage);
  EXPECT_EQ(code({.undone = false, .strokes = {a}}), kBadMessage);
  EXPECT_EQ(code({.undone = true, .participant = 77}), kBadMessage);
  session_->people().set_role_of("", Role::kSculptor);
  StrokeRequest others{.undone = true, .strokes = {b}, .author = ada};
  // On a server without rights everybody is an administrator, who may do so.
  EXPECT_EQ(code(others), std::nullopt);
  EXPECT_EQ(code({.undone = false, .strokes = {b}}), std::nullopt);
  EXPECT_EQ(hash(), before);
  EXPECT_EQ(session_->sequence(), records + 2);
  Caller watcher{.role = Role::kWatcher};
  std::expected<StrokesChanged, Rejection> refused;
  auto asked = std::async(std::launch::async, [&] {
    SerialWorkers alone;
    return session_->stroke_changes().change({.strokes = {a}, .caller = watcher}, alone);
  });
  while (asked.wait_for(std::chrono::milliseconds(1)) != std::future_status::ready) {
    executor_->run();
  }
  refused = asked.get();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, kNotAllowed);
  EXPECT_EQ(session_->sequence(), records + 2);
}

TEST_F(SessionUndo, FailedCarvingIsRetried) {
  create();
  const ParticipantId ada = join("Ada");
  const std::uint64_t untouched = hash();
  const StrokeId a = stroke(ada, {-15, 0, -2}, {15, 0, -2});
  // The client disconnects once the change has been journaled.
  std::stop_source gone;
  const std::uint64_t records = session_->sequence();
  const auto changed = change(
      {.undone = true, .strokes = {a}},
      [&] {
        if (session_->sequence() > records) gone.request_stop();
      },
      gone.get_token());
  ASSERT_TRUE(changed);
  if (changed->pending) {
    EXPECT_TRUE(session_->is_between_records());
    EXPECT_NE(hash(), untouched);
    std::atomic<bool> done = false;
    executor_->run(true);
    std::thread worker([&] {
      workers_.run();
      done = true;
    });
    while (!done) executor_->run();
    worker.join();
    executor_->run();
  }
  EXPECT_FALSE(session_->is_between_records());
  EXPECT_EQ(hash(), untouched);
}

}  // namespace
}  // namespace kerf::session_undo_test
