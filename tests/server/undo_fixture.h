// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/history/recorded_block.h"
#include "tests/server/session_fixture.h"
#include "tests/server/shared_executor.h"
#include "tests/support/test.h"
#include "tests/support/thread_workers.h"

namespace kerf {

class SessionUndo : public testing::Test {
 protected:
  void SetUp() override { restart(); }
  void restart() {
    session_.reset();
    registry_.emplace(
        RegistryOptions{.data_folder = folder_->path(),
                        .sessions_max = 4,
                        .session = limits_,
                        .snapshots = snapshots_,
                        .carvers = carvers_,
                        .matters = matters_},
        [this](const std::string&) { return executor_; }, workers_);
  }
  /// Discards everything and starts again.
  void renew() {
    session_.reset();
    registry_.reset();
    folder_.emplace();
    sequences_.clear();
    restart();
  }
  Session& create(const std::string& scene = kScene) {
    auto created = registry_->create("block", scene, SceneSource{});
    EXPECT_TRUE(created) << created.error().reason;
    session_ = *created;
    return *session_;
  }
  Session& reload() {
    executor_->run();
    const std::string id = session_ ? session_->id() : "block";
    session_.reset();
    restart();
    EXPECT_TRUE(registry_->load_all().failures.empty());
    session_ = registry_->find(id);
    EXPECT_TRUE(session_);
    return *session_;
  }
  /// Deletes a session.
  void close(const std::string& id) {
    auto closed = std::async(std::launch::async, [&] { return registry_->close(id, true); });
    while (closed.wait_for(std::chrono::microseconds(200)) != std::future_status::ready) {
      executor_->run();
    }
    EXPECT_TRUE(closed.get());
  }
  ParticipantId join(const std::string& name, bool stock = false) {
    JoinRequest request{ParticipantKind::kAgent, name, "", 1, true};
    request.stock = stock;
    const auto joined = session_->join(request);
    EXPECT_TRUE(joined);
    return joined->id;
  }
  /// The next sample of a participant with an upright tool 1.
  wire::MotionSample next(ParticipantId id, Vec3 tip, bool cuts) {
    return wire::MotionSample{.agent_sequence = ++sequences_[id],
                              .time_us = 1000 * ++time_ms_,
                              .tip_mm = tip,
                              .tool_id = 1,
                              .buttons = cuts ? wire::kButtonCutting : 0};
  }
  /// Moves the tool of a participant, cutting unless `cuts` is false.
  MotionAnswer move(ParticipantId id, Vec3 tip, bool cuts = true) {
    const wire::MotionSample sample = next(id, tip, cuts);
    return session_->move(id, {&sample, 1});
  }
  /// Cuts a stroke along a line at a depth. Returns its number.
  StrokeId stroke(ParticipantId id, Vec3 from, Vec3 to, int steps = 20) {
    move(id, from + Vec3{0, 0, 10}, false);
    move(id, from, false);
    const std::uint64_t first = session_->sequence() + 1;
    for (int n = 1; n <= steps; ++n) {
      move(id, from + (to - from) * (static_cast<double>(n) / steps));
    }
    move(id, to + Vec3{0, 0, 10}, false);
    return first;
  }
  /// Carries out a request on another thread. Calls `meanwhile` between the turns of the session's
  /// executor.
  std::expected<StrokesChanged, Rejection> change(
      StrokeRequest request, const std::function<void()>& meanwhile = [] {},
      const std::stop_token& stop = {}) {
    if (request.author == 0) request.caller = Caller::local();
    auto answer = std::async(std::launch::async, [&] {
      test::ThreadWorkers two(2);
      return session_->stroke_changes().change(request, carvers_ != nullptr ? *carvers_ : two,
                                               stop);
    });
    while (answer.wait_for(std::chrono::microseconds(200)) != std::future_status::ready) {
      executor_->run();
      meanwhile();
    }
    executor_->run();
    return answer.get();
  }
  StrokesChanged undo(std::vector<StrokeId> strokes) {
    auto done = change({.undone = true, .strokes = std::move(strokes)});
    EXPECT_TRUE(done) << done.error().reason;
    return done.value_or(StrokesChanged{});
  }
  StrokesChanged redo(std::vector<StrokeId> strokes) {
    auto done = change({.undone = false, .strokes = std::move(strokes)});
    EXPECT_TRUE(done) << done.error().reason;
    return done.value_or(StrokesChanged{});
  }
  /// Returns the hash of a block in which the strokes undone as of a record, by default the last
  /// one, never happened.
  std::uint64_t never_happened(std::uint64_t record = std::numeric_limits<std::uint64_t>::max()) {
    EXPECT_TRUE(session_->flush());
    auto reader = JournalReader::open(session_->journal_file());
    std::vector<JournalRecord> records;
    std::set<StrokeId> undone;
    for (auto next = reader->next(); next && *next && (*next)->sequence <= record;
         next = reader->next()) {
      records.push_back(**next);
      const auto* change = std::get_if<StrokeChange>(&(*next)->command);
      if (change == nullptr) continue;
      if (change->undone) {
        undone.insert(change->stroke);
      } else {
        undone.erase(change->stroke);
      }
    }
    Sculpture block = Sculpture::create(session_->scene()->settings).value();
    for (const JournalRecord& past : records) {
      const auto command = kernel_command(past.command);
      if (command && !undone.contains(past.stroke)) block.apply(*command).value();
    }
    return block.state_hash();
  }
  std::uint64_t hash() { return session_->solid().hash(); }

  SessionLimits limits_ = {};
  SnapshotOptions snapshots_ = {};   ///< none by default
  std::vector<MakeMatter> matters_;  ///< none by default
  Workers* carvers_ = nullptr;       ///< threads for carving and undo; null: undo uses two threads
  std::optional<test::TemporaryFolder> folder_{std::in_place};
  std::shared_ptr<test::SharedExecutor> executor_ = std::make_shared<test::SharedExecutor>();
  test::SharedExecutor workers_;
  std::optional<SessionRegistry> registry_;
  std::shared_ptr<Session> session_;
  std::map<ParticipantId, std::uint64_t> sequences_;
  std::uint64_t time_ms_ = 0;
};

}  // namespace kerf
