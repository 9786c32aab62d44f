// SPDX-License-Identifier: Apache-2.0
// Random sessions: hands rest, change tools, jump, lose their connections and resend samples that
// are not durable; strokes are undone and redone; servers restart; programs run. The block must
// match its journal, and exported programs must carve it again to the bit.
#include <algorithm>
#include <chrono>
#include <deque>
#include <random>
#include <thread>

#include "server/formats/pose_grid.h"
#include "tests/server/export_fixture.h"
#include "tests/server/rack_scene.h"
#include "tests/server/random_runs.h"

namespace kerf::random_export_test {
namespace {

/// Maximum number of samples in a message.
constexpr std::size_t kBatchMax = 16;

/// An agent and its connection.
struct Hand {
  ParticipantId id = 0;
  std::string token;
  std::deque<wire::MotionSample> kept = {};  ///< not durable, and the last durable one
  std::uint64_t sent = 0;                    ///< newest sample that the session has received
  bool is_connected = true;
  Vec3 tip{0, 0, 5}, axis{0, 0, 1};
  std::uint32_t tool = 1;
  bool cuts = false;
};

class RandomExport : public SessionExport {
 protected:
  void run(unsigned seed, int rounds) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    random_.seed(seed);
    limits_.samples_per_s = limits_.samples_burst = 1e9;
    limits_.carver_joins_per_s = limits_.carver_joins_burst = 1e9;
    renew();
    create(scene());
    hands_.clear();
    for (const char* name : {"Ada", "Bo", "Cy"}) {
      const auto admission = session_->admit(request(name));
      ASSERT_TRUE(admission);
      hands_.push_back({.id = admission->participant.id, .token = admission->token});
    }
    for (int round = 0; round < rounds; ++round) {
      SCOPED_TRACE("round " + std::to_string(round));
      step();
      settle();
      expect_equal_exports();
      if (HasFailure()) return;
    }
  }

 private:
  std::string scene() {
    const bool is_tri = one_of(4) == 0;
    std::string text =
        rack_scene(is_tri ? "tri-dexel" : "dexel", one_of(4) == 0 ? "paper" : "tight");
    // Makes the large mill more work than one turn.
    is_fine_ = !is_tri && one_of(4) == 0;
    if (is_fine_) text.replace(text.find("\"pitch_mm\": 0.6"), 15, "\"pitch_mm\": 0.1");
    text.replace(text.find("\"tools\": ["), 10,
                 R"("tools": [{"id": 12, "shape": "flat", "diameter_mm": 60, "length_mm": 30}, )");
    if (one_of(2) == 0) {
      text.insert(text.rfind('}'), R"(, "obstacles": [{"shape": "box", "min_mm": [-20, -20, 50],
        "max_mm": [20, 20, 55], "stiffness_n_per_mm": 2}])");
    }
    return text;
  }
  static JoinRequest request(const char* name) {
    JoinRequest request{ParticipantKind::kAgent, name, "", 1, true};
    request.durable = true;
    return request;
  }

  void step() {
    const auto kind = one_of(20);
    if (kind < 12) {
      const auto steps = 20 + one_of(200);
      for (std::size_t n = 0; n < steps; ++n) move_some();
    } else if (kind < 15) {
      change_some(true);
    } else if (kind < 17) {
      change_some(false);
    } else if (kind < 18) {
      restart_server();
    } else {
      start_some_program();
    }
  }

  /// Completes everything in progress. All samples arrive.
  void settle() {
    for (Hand& hand : hands_) {
      while (!hand.is_connected) {
        connect(hand);
        if (HasFailure()) return;
        if (!hand.is_connected) std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
      deliver(hand);
    }
    executor_->run(true);
    while (session_->is_between_records()) executor_->run(true);
  }

  void move_some() {
    Hand& hand = hands_[one_of(hands_.size())];
    const auto samples = 1 + one_of(kBatchMax);
    for (std::size_t n = 0; n < samples; ++n) hand.kept.push_back(next_sample(hand));
    if (hand.is_connected && one_of(100) == 0) {
      hand.is_connected = false;
      if (one_of(2) == 0) session_->leave(hand.id);  // otherwise the loss goes unnoticed
    } else if (!hand.is_connected && one_of(4) == 0) {
      connect(hand);
    }
    if (hand.is_connected) deliver(hand);
    executor_->run_one(one_of(10) == 0);
  }

  wire::MotionSample next_sample(Hand& hand) {
    const auto kind = one_of(100);
    if (kind < 3) {
      hand.tool = 1 + static_cast<std::uint32_t>(one_of(is_fine_ ? kRackTools + 1 : kRackTools));
    } else if (kind < 8) {
      hand.cuts = !hand.cuts;
    } else if (kind < 10) {
      hand.tip = {uniform(-18, 18), uniform(-18, 18), uniform(-6, 10)};
    } else if (kind > 20) {
      hand.tip = hand.tip + Vec3{uniform(-0.6, 0.6), uniform(-0.6, 0.6), uniform(-0.4, 0.4)};
      hand.tip.z = std::clamp(hand.tip.z, -8.0, 10.0);
    }
    if (kind > 70) {
      hand.axis = normalized({std::clamp(hand.axis.x + uniform(-0.02, 0.02), -0.5, 0.5),
                              std::clamp(hand.axis.y + uniform(-0.02, 0.02), -0.5, 0.5), 1});
    }
    wire::MotionSample sample = next(hand.id, hand.tip, hand.cuts);
    sample.axis = {float(hand.axis.x), float(hand.axis.y), float(hand.axis.z)};
    sample.tool_id = hand.tool;
    if (kind == 11) sample.axis = {0, 0, 0};                             // rejected
    if (kind == 12) sample.tool_id = 99;                                 // rejected
    if (kind == 13) sample.time_us -= 1000;                              // no time has passed
    if (kind == 14) time_ms_ += one_of(200);                             // a pause of the agent
    if (kind == 15 && one_of(4) == 0) sequences_[hand.id] += one_of(5);  // lost samples
    return sample;
  }

  /// Sends the samples that the session lacks and forgets durable ones.
  void deliver(Hand& hand) {
    std::vector<wire::MotionSample> samples;
    for (const wire::MotionSample& sample : hand.kept) {
      if (sample.agent_sequence > hand.sent) samples.push_back(sample);
    }
    for (std::size_t n = 0; n < samples.size(); n += kBatchMax) {
      const std::size_t count = std::min(kBatchMax, samples.size() - n);
      auto answer = session_->begin_move(hand.id, std::span(samples).subspan(n, count));
      while (!answer) {
        executor_->run_one(true);
        answer = session_->go_on(hand.id);
      }
      hand.sent = samples[n + count - 1].agent_sequence;
    }
    const std::uint64_t durable = session_->durable_sequence(hand.id);
    while (hand.kept.size() > 1 && hand.kept[1].agent_sequence <= durable) hand.kept.pop_front();
  }

  /// No effect if it has reconnected too often.
  void connect(Hand& hand) {
    JoinRequest again = request("again");
    again.token = hand.token;
    const auto admission = session_->admit(again);
    if (!admission && admission.error().code == wire::ErrorCode::kBusy) return;
    ASSERT_TRUE(admission) << admission.error().reason;
    EXPECT_TRUE(admission->resumed);
    EXPECT_EQ(admission->participant.id, hand.id);
    EXPECT_LE(admission->agent_sequence, sequences_[hand.id]);
    hand.is_connected = true;
    // Resends all samples that may not be durable, or starts at some known sample.
    const std::uint64_t known = admission->agent_sequence;
    hand.sent = one_of(2) == 0 ? 0 : known - std::min<std::uint64_t>(known, one_of(20));
  }

  void restart_server() {
    // Otherwise they would continue and write to the next server's journal.
    for (const ProgramStatus& program : session_->programs().list())
      session_->programs().cancel(program.id);
    settle();
    reload();
    for (Hand& hand : hands_) {
      hand.is_connected = false;
      connect(hand);
    }
  }

  void change_some(bool undone) {
    std::vector<StrokeId> possible;
    const auto strokes = session_->past().strokes(0);
    for (const ListedStroke& listed : strokes.value()) {
      if (listed.is_undone != undone) possible.push_back(listed.stroke.id);
    }
    std::ranges::shuffle(possible, random_);
    possible.resize(std::min(possible.size(), 1 + one_of(3)));
    if (possible.empty()) return;
    int moves = 0;
    const auto done = change({.undone = undone, .strokes = std::move(possible)}, [&] {
      if (++moves < 20) move_some();
    });
    EXPECT_TRUE(done) << done.error().reason;
  }

  void start_some_program() {
    Program program{.name = "random.ngc"};
    ToolPose at{{uniform(-18, 18), uniform(-18, 18), uniform(-6, 10)}, {0, 0, 1}};
    ToolId tool = 1 + static_cast<ToolId>(one_of(kRackTools));
    const auto motions = 1 + one_of(60);
    for (std::size_t n = 0; n < motions; ++n) {
      if (one_of(20) == 0) tool = 1 + static_cast<ToolId>(one_of(kRackTools));
      if (one_of(20) == 0) at.tip_mm = {uniform(-18, 18), uniform(-18, 18), uniform(-6, 10)};
      ToolPose to = at;
      if (one_of(8) != 0) {
        to.tip_mm = to.tip_mm + Vec3{uniform(-2, 2), uniform(-2, 2), uniform(-1, 1)};
        if (one_of(3) == 0) to.axis = normalized({uniform(-0.5, 0.5), uniform(-0.5, 0.5), 1});
      }
      program.motions.push_back({tool, at, admit_pose(to), uniform(0.001, 0.1)});
      program.motions.back().from = admit_pose(at);
      at = program.motions.back().to;
    }
    const auto started = session_->programs().start(std::move(program), {ProgramPace::kFast});
    ASSERT_TRUE(started) << started.error().reason;
    for (int n = 0; n < 40; ++n) move_some();
    if (one_of(4) == 0) session_->programs().cancel(started->id);
  }

  std::size_t one_of(std::size_t count) { return random_() % count; }
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }

  std::mt19937 random_;
  std::vector<Hand> hands_;
  bool is_fine_ = false;
};

TEST_F(RandomExport, CarvesTheBlockOfTheSessionToTheBit) {
  constexpr RandomRuns kSessions{.first_seed = 1, .count = 2, .rounds = 5};
  kSessions.each([this](unsigned seed, int rounds) { run(seed, rounds); });
}

}  // namespace
}  // namespace kerf::random_export_test
