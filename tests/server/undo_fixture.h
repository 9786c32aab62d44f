// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/history/recorded_block.h"
#include "tests/server/session_fixture.h"
#include "tests/support/thread_workers.h"

namespace kerf {

/// A ManualExecutor to which other threads may post.
class SharedExecutor final : public Executor {
 public:
  void post(Work work) override {
    const std::lock_guard lock(mutex_);
    queue_.post(std::move(work));
  }
  void post_after(std::chrono::microseconds delay, Work work) override {
    const std::lock_guard lock(mutex_);
    queue_.post_after(delay, std::move(work));
  }
  /// Runs all that is posted and, with `delayed`, all that waits.
  void run(bool delayed = false) {
    for (;;) {
      Work next;
      {
        const std::lock_guard lock(mutex_);
        if (std::exchange(delayed, false)) queue_.release_delayed();
        auto work = queue_.take_one();
        if (!work) return;
        next = *std::move(work);
      }
      next();
    }
  }
  std::size_t waiting() {
    const std::lock_guard lock(mutex_);
    return queue_.waiting();
  }

 private:
  std::mutex mutex_;
  test::ManualExecutor queue_;
};

class SessionUndo : public testing::Test {
 protected:
  void SetUp() override { restart(); }
  void restart() {
    session_.reset();
    registry_.emplace(
        RegistryOptions{folder_->path(), 4, limits_, {}, {}},
        [this](const std::string&) { return executor_; }, workers_);
  }
  /// Forgets everything.
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
    session_.reset();
    restart();
    EXPECT_TRUE(registry_->load_all().failures.empty());
    session_ = registry_->find("block");
    EXPECT_TRUE(session_);
    return *session_;
  }
  ParticipantId join(const std::string& name, bool stock = false) {
    JoinRequest request{ParticipantKind::kAgent, name, "", 1, true};
    request.stock = stock;
    const auto joined = session_->join(request);
    EXPECT_TRUE(joined);
    return joined->id;
  }
  /// Moves the tool of a participant, which cuts, or with `cuts` false only moves.
  MotionAnswer move(ParticipantId id, Vec3 tip, bool cuts = true) {
    wire::MotionSample sample;
    sample.agent_sequence = ++sequences_[id];
    sample.time_us = 1000 * ++time_ms_;
    sample.tip_mm = tip;
    sample.tool_id = 1;
    sample.buttons = cuts ? wire::kButtonCutting : 0;
    return session_->move(id, {&sample, 1});
  }
  /// A stroke along a line at a depth; returns its number.
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
  /// Carries out a request on another thread, and calls `meanwhile` between the turns of the
  /// session's executor.
  std::expected<StrokesChanged, Rejection> change(
      StrokeRequest request, const std::function<void()>& meanwhile = [] {},
      const std::stop_token& stop = {}) {
    if (request.author == 0) request.caller = Caller::local();
    auto answer = std::async(std::launch::async, [&] {
      test::ThreadWorkers two(2);
      return session_->change_strokes(request, two, stop);
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
  /// The hash of a block in which the strokes that are undone have never happened.
  std::uint64_t never_happened() {
    EXPECT_TRUE(session_->flush());
    const auto undone = undone_strokes(session_->journal_file());
    EXPECT_TRUE(undone);
    auto reader = JournalReader::open(session_->journal_file());
    Sculpture block = Sculpture::create(session_->scene().settings).value();
    for (auto record = reader->next(); record && *record; record = reader->next()) {
      const auto command = kernel_command((*record)->command);
      if (command && !undone->contains((*record)->stroke)) block.apply(*command).value();
    }
    return block.state_hash();
  }
  std::uint64_t hash() { return session_->solid().hash(); }

  SessionLimits limits_ = {};
  std::optional<test::TemporaryFolder> folder_{std::in_place};
  std::shared_ptr<SharedExecutor> executor_ = std::make_shared<SharedExecutor>();
  SharedExecutor workers_;
  std::optional<SessionRegistry> registry_;
  std::shared_ptr<Session> session_;
  std::map<ParticipantId, std::uint64_t> sequences_;
  std::uint64_t time_ms_ = 0;
};

}  // namespace kerf
