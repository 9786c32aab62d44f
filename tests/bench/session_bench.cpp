// SPDX-License-Identifier: Apache-2.0
// Measures how many agents one session carries, in process: session_bench [threads=cores]
// [agents=16] [samples=1] [seconds=1] [turns=3] [pitch_mm=0.1], or session_bench carries [threads]
// [seconds] [turns] [pitch_mm]
//
// Balls of 10 mm move 0.1 mm and 0.25 degrees per sample. "apart": each in fresh stock of its own.
// "one place": all within a few mm. Sockets and clients are left out, because they would use the
// same cores. The numbers of threads are measured in turn.
//
// capacity: frames of all agents come together, `samples` in each, repeatedly. Motions per
//           second of wall time, the best of all turns.
// load:     every agent sends 1000 samples per second. The time from the moment at which a sample
//           is due to its answer, in the turn with the least p99.
// carries:  the greatest number of agents up to which that p99 is at most 1 ms.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/session/session_registry.h"
#include "server/threads/thread_pool.h"
#include "tests/server/manual_executor.h"
#include "tests/support/temporary_folder.h"

namespace kerf {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr double kStripMm = 25, kLengthMm = 100, kStepMm = 0.1;

std::string scene_of(int agents, double pitch_mm) {
  return R"({"name": "bench", "stock": {"shape": "box", "min_mm": [0, 0, -30], "max_mm": [)" +
         std::to_string(kLengthMm) + ", " + std::to_string(kStripMm * agents) +
         R"(, 0]}, "accuracy": {"rays": "dexel", "pitch_mm": )" + std::to_string(pitch_mm) +
         R"(, "tolerance_mm": 0.01, "motion": "tight"},
             "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60}],
             "machine": {"kinematics": "tool-vector"}})";
}

/// Returns a sample of an agent: rows 4 mm apart and, in the same strip, layers 3 mm deep.
wire::MotionSample sample_of(int agent, bool apart, std::uint64_t n) {
  const double along = double(n) * kStepMm;
  const auto row = static_cast<int>(along / kLengthMm);
  const double x = along - row * kLengthMm;
  const double lean = 0.25 * 3.14159265358979 / 180 * std::abs(double(n % 160) - 80);
  wire::MotionSample sample{.agent_sequence = n + 1, .time_us = 1000 * (n + 1)};
  const double y =
      apart ? kStripMm * (agent + 0.25) + 4 * (row % 4) : 8 + 0.3 * agent + 4 * (row % 4);
  sample.tip_mm = {row % 2 == 0 ? x : kLengthMm - x, y, -3.0 * (1 + row / 4)};
  sample.axis = {float(std::sin(lean)), 0, float(std::cos(lean))};
  sample.tool_id = 1;
  sample.buttons = wire::kButtonCutting;
  return sample;
}

/// A new session with agents that have begun to move.
struct Bench {
  Bench(int agents, bool are_apart, double pitch_mm, Workers* carvers)
      : apart(are_apart),
        registry(
            {folder.path(), 4, limits(), {}, {}, {}, carvers},
            [this](const std::string&) { return executor; }, background) {
    session = registry.create("bench", scene_of(agents, pitch_mm), SceneSource{}).value();
    for (int a = 0; a < agents; ++a) {
      ids.push_back(session->join({ParticipantKind::kAgent, "hand", "", 1, true})->id);
      const wire::MotionSample first = sample_of(a, apart, 0);
      session->move(ids.back(), {&first, 1});
    }
    sent.assign(ids.size(), 1);
  }
  static SessionLimits limits() {
    SessionLimits limits;
    limits.samples_per_s = limits.samples_burst = 1e9;
    limits.carver_joins_burst = 1e9;
    limits.agents_max = 64;
    return limits;
  }
  /// Receives the next frame of an agent. Returns true if it is answered at once.
  bool receive(std::size_t agent, int samples) {
    frame.clear();
    for (int n = 0; n < samples; ++n) {
      frame.push_back(sample_of(static_cast<int>(agent), apart, sent[agent]++));
    }
    return session->begin_move(ids[agent], frame).has_value();
  }

  bool apart;
  test::TemporaryFolder folder;
  std::shared_ptr<test::ManualExecutor> executor = std::make_shared<test::ManualExecutor>();
  test::ManualExecutor background;
  SessionRegistry registry;
  std::shared_ptr<Session> session;
  std::vector<ParticipantId> ids;
  std::vector<std::uint64_t> sent;
  std::vector<wire::MotionSample> frame;
};

double motions_per_s(Bench& bench, int samples, double seconds) {
  const auto start = Clock::now();
  std::uint64_t motions = 0;
  std::vector<std::size_t> open;
  while (seconds_since(start) < seconds) {
    open.clear();
    for (std::size_t a = 0; a < bench.ids.size(); ++a) {
      if (!bench.receive(a, samples)) open.push_back(a);
    }
    for (const std::size_t a : open) {
      while (!bench.session->go_on(bench.ids[a])) {
      }
    }
    motions += bench.ids.size() * std::size_t(samples);
  }
  return double(motions) / seconds_since(start);
}

struct Latency {
  double p50_ms = 1e9, p99_ms = 1e9;
};

/// Serves frames that are due at 1 kHz, for each agent at a phase of its own, as the thread of a
/// session does: it receives all that have come, and then carves.
Latency latency(Bench& bench, double seconds) {
  std::vector<double> times_ms;
  const std::size_t agents = bench.ids.size();
  const auto start = Clock::now();
  const auto due_s = [&](std::size_t agent) {
    return 1e-3 * (double(bench.sent[agent]) + double(agent * 7 % agents) / double(agents));
  };
  const auto note = [&](double due) { times_ms.push_back(1e3 * (seconds_since(start) - due)); };
  std::vector<std::pair<std::size_t, double>> open;
  while (seconds_since(start) < seconds) {
    open.clear();
    const double now_s = seconds_since(start);
    for (std::size_t a = 0; a < agents; ++a) {
      const double due = due_s(a);
      if (due > now_s) continue;
      if (bench.receive(a, 1)) {
        note(due);
      } else {
        open.emplace_back(a, due);
      }
    }
    for (const auto& [agent, due] : open) {
      while (!bench.session->go_on(bench.ids[agent])) {
      }
      note(due);
    }
  }
  std::ranges::sort(times_ms);
  return {times_ms[times_ms.size() / 2], times_ms[times_ms.size() * 99 / 100]};
}

void measure(int agents, bool apart, int samples, double pitch_mm, double seconds, int turns,
             std::span<Workers* const> carvers) {
  std::vector<double> best(carvers.size(), 0);
  std::vector<Latency> least(carvers.size());
  for (int turn = 0; turn < turns; ++turn) {
    for (std::size_t k = 0; k < carvers.size(); ++k) {
      Bench full(agents, apart, pitch_mm, carvers[k]);
      best[k] = std::max(best[k], motions_per_s(full, samples, seconds));
      Bench timed(agents, apart, pitch_mm, carvers[k]);
      const Latency now = latency(timed, seconds);
      if (now.p99_ms < least[k].p99_ms) least[k] = now;
    }
  }
  std::printf("%2d agents %-10s", agents, apart ? "apart" : "one place");
  for (std::size_t k = 0; k < carvers.size(); ++k) {
    std::printf("  | %d: %6.0f motions/s x %.2f, at 1 kHz p50 %7.2f p99 %7.2f ms",
                carvers[k] == nullptr ? 1 : carvers[k]->count(), best[k], best[k] / best[0],
                least[k].p50_ms, least[k].p99_ms);
  }
  std::printf("\n");
  std::fflush(stdout);
}

/// Prints, for each number of threads, how many agents are answered within 1 ms.
void carries(double seconds, int turns, double pitch_mm, std::span<Workers* const> carvers) {
  constexpr int kAgentsMax = 48;
  for (Workers* const workers : carvers) {
    std::printf("%d threads:", workers == nullptr ? 1 : workers->count());
    int carried = 0;
    for (int agents = 2; agents <= kAgentsMax; agents += 2) {
      Latency least;
      for (int turn = 0; turn < turns && least.p99_ms > 1; ++turn) {
        Bench bench(agents, true, pitch_mm, workers);
        const Latency now = latency(bench, seconds);
        if (now.p99_ms < least.p99_ms) least = now;
      }
      std::printf(" %d %.2f ms,", agents, least.p99_ms);
      std::fflush(stdout);
      if (least.p99_ms > 1) break;
      carried = agents;
    }
    std::printf(" carries %d agents apart at p99 <= 1 ms\n", carried);
  }
}

}  // namespace
}  // namespace kerf

int main(int argc, char** argv) {
  using namespace kerf;
  const bool asks_carries = argc > 1 && std::string_view(argv[1]) == "carries";
  if (asks_carries) ++argv, --argc;
  const int threads = argc > 1 ? std::atoi(argv[1]) : usable_threads();
  ThreadPool pool(std::max(1, threads), ThreadPool::Idle::kSleeps);
  std::vector<Workers*> carvers{nullptr};
  if (threads > 1) carvers.push_back(&pool);
  if (asks_carries) {
    carries(argc > 2 ? std::atof(argv[2]) : 1, argc > 3 ? std::atoi(argv[3]) : 3,
            argc > 4 ? std::atof(argv[4]) : 0.1, carvers);
    return 0;
  }
  const int agents = argc > 2 ? std::atoi(argv[2]) : 16;
  const int samples = argc > 3 ? std::atoi(argv[3]) : 1;
  const double seconds = argc > 4 ? std::atof(argv[4]) : 1;
  const int turns = argc > 5 ? std::atoi(argv[5]) : 3;
  const double pitch_mm = argc > 6 ? std::atof(argv[6]) : 0.1;
  std::printf("by number of threads\n");
  measure(agents, true, samples, pitch_mm, seconds, turns, carvers);
  measure(agents, false, samples, pitch_mm, seconds, turns, carvers);
  return 0;
}
