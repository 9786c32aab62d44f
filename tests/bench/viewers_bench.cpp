// SPDX-License-Identifier: Apache-2.0
// A crowd of viewers: a real kerf-server as a child process, viewers that join one session as fast
// as they can and read everything, and an agent that changes its tool all the time.
//
//   viewers_bench [--server PATH] [--viewers N] [--seconds S] [--agents N] [--busy N] [--calm]
//                 [--lists]
//
// Prints how many viewers joined and were dropped, the bytes of text that the server sent to all of
// them together, the time until the last welcome, and the server's CPU time and memory.
//
// --seconds S  keeps the viewers for S seconds after the last welcome (default 3)
// --agents N   instead of the agent that changes its tool, N agents cut a raster at 1 kHz, for S
//              seconds without viewers and for S seconds with them, in turns of up to 2 s: first in
//              a session that nobody watches, then in that of the viewers, on the same server and
//              with the same connections. Prints the round trips of each turn, and how many times
//              longer the p99 is with viewers; the mesh frames and bytes to each viewer and their
//              CPU time in the server; and the staleness of the frames: the time from the answer to
//              a motion to its agent until a viewer has a frame that includes it, for the oldest
//              motion that each frame adds. All share one machine, so the viewers here have a lower
//              priority than the server's threads for viewers, and the agents SCHED_FIFO, if
//              allowed, as kerf-agent has. Prints the CPU time of other programs too ("foreign"):
//              an agent waits for tens of ms while a program of another terminal or service has the
//              core of the session's thread, because Linux shares a core among those first
//              (autogroups, cgroups) and the server has used its share. A turn in which foreign
//              programs used more than a few hundredths of a core says little about the server.
// --busy N     N processes that never sleep compete with the server, while downloads are made one
//              after the other. The viewers here count as another machine (SCHED_FIFO). Prints the
//              share of a core that each kind of the server's threads got while runnable, and that
//              of the N processes.
// --calm       no agent
// --lists      the viewers do not support 'participants_changed' and get complete lists
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/wire/codec.h"
#include "tests/bench/busy_loops.h"
#include "tests/bench/crowd.h"
#include "tests/bench/crowd_viewer.h"
#include "tests/bench/downloads.h"
#include "tests/bench/live_client.h"
#include "tests/bench/raster.h"

namespace {

using namespace kerf::wire;
using namespace kerf::bench;

struct Options {
  std::string server = KERF_SERVER_PROGRAM;
  int viewers = 1000, agents = 0, busy = 0;
  double seconds = 3;
  bool calm = false, lists = false;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const bool has_value = i + 1 < argc;
    if (word == "--calm") {
      options.calm = true;
    } else if (word == "--lists") {
      options.lists = true;
    } else if (word == "--server" && has_value) {
      options.server = argv[++i];
    } else if (word == "--viewers" && has_value) {
      options.viewers = std::atoi(argv[++i]);
    } else if (word == "--agents" && has_value) {
      options.agents = std::clamp(std::atoi(argv[++i]), 0, 15);
    } else if (word == "--busy" && has_value) {
      options.busy = std::clamp(std::atoi(argv[++i]), 0, 64);
    } else if (word == "--seconds" && has_value) {
      options.seconds = std::atof(argv[++i]);
    } else {
      fail("unknown option " + std::string(word));
    }
  }
  return options;
}

void change_tools(const std::atomic<bool>& stop, std::uint16_t port) {
  WebSocket agent(port, "/v1/sessions/bench/agent", "kerf.agent.v1");
  const auto say = [&](const std::string& text) { agent.send(1, std::as_bytes(std::span(text))); };
  say(R"({"type":"hello","name":"Ada"})");
  std::string payload;
  for (int n = 0; !stop; ++n) {
    say(n % 2 == 0 ? R"({"type":"tool","tool":2})" : R"({"type":"tool","tool":1})");
    while (agent.receive(payload, in_seconds(0.002)) != 0) continue;
  }
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

void print_memory(const std::vector<double>& memory_mb) {
  std::printf("the server's memory at the start, and after each sixth of the time:");
  for (const double mb : memory_mb) std::printf(" %.1f", mb);
  std::printf(" MB\n");
}

/// Longest turn, so that most turns are free of occasional activity of other programs.
constexpr double kTurnS = 2;

/// Returns the CPU time that all programs of the machine have used, s (proc_stat(5)).
double machine_cpu_seconds() {
  std::ifstream stat("/proc/stat");
  std::string name;
  double user = 0, nice = 0, system = 0, idle = 0, waiting = 0, irq = 0, softirq = 0;
  stat >> name >> user >> nice >> system >> idle >> waiting >> irq >> softirq;
  return (user + nice + system + irq + softirq) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// Resources used in the turns of agents with viewers, or without them.
struct Used {
  std::vector<double> trips_us;
  double seconds = 0, server_s = 0, viewers_s = 0, foreign_s = 0;
  CoreTime busy, session;  ///< of the busy processes, and of the session's thread
  std::map<std::string, CoreTime> threads;
};

/// The server and the processes that compete with it for the cores.
struct Bench {
  const Options& options;
  const ServerProcess& server;
  const Crowd& crowd;
  const BusyLoops& busy;

  /// CPU time of the server, of the viewers and of everything that belongs to the bench, s.
  struct Consumed {
    double server_s = 0, viewers_s = 0, all_s = 0, machine_s = 0;
  };
  Consumed consumed() const {
    Consumed now{server.cpu_seconds(), crowd.cpu_seconds(), 0, machine_cpu_seconds()};
    now.all_s = now.server_s + now.viewers_s + process_cpu_seconds(getpid()) + busy.time().ran;
    return now;
  }
  /// Returns the p99 of the round trips, us.
  double turn(Raster& raster, std::uint64_t samples, Used& used) const {
    const auto threads = core_times(server.pid());
    const Consumed before_turn = consumed();
    const CoreTime others = busy.time();
    const auto start = Clock::now();
    auto trips = raster.cut(samples);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const Consumed after_turn = consumed();
    const double foreign_s = std::max(
        0.0, after_turn.machine_s - before_turn.machine_s - (after_turn.all_s - before_turn.all_s));
    used.seconds += seconds;
    used.server_s += after_turn.server_s - before_turn.server_s;
    used.viewers_s += after_turn.viewers_s - before_turn.viewers_s;
    used.foreign_s += foreign_s;
    used.busy += busy.time() - others;
    for (const auto& [name, time] : core_times(server.pid())) {
      const auto before = threads.find(name);
      const CoreTime spent = before == threads.end() ? time : time - before->second;
      used.threads[name] += spent;
      if (name == raster.thread_name()) used.session += spent;
    }
    std::printf(" p50 %.0f us, p99 %.0f us (foreign %.2f cores)", at_share(trips, 0.5),
                at_share(trips, 0.99), foreign_s / seconds);
    used.trips_us.insert(used.trips_us.end(), trips.begin(), trips.end());
    return at_share(trips, 0.99);
  }
};

void print_viewers(const Options& options, const CrowdReport& report, const Used& without,
                   const Used& beside) {
  const double each = 1.0 / options.viewers, all = double(report.mesh_frames.load());
  std::printf(
      "each viewer: %.1f mesh frames/s, %.0f kB/s; staleness p50 %zu ms, p99 %zu ms; each costs "
      "the server %.2f ms of CPU per second\n",
      all * each / beside.seconds, double(report.mesh_bytes) * each / beside.seconds / 1e3,
      report.stale_at(0.5), report.stale_at(0.99),
      1e3 * each * (beside.server_s / beside.seconds - without.server_s / without.seconds));
  std::printf(
      "cores used: server %.2f without the viewers, %.2f beside them; viewers %.2f; foreign %.2f "
      "and %.2f\n",
      without.server_s / without.seconds, beside.server_s / beside.seconds,
      beside.viewers_s / beside.seconds, without.foreign_s / without.seconds,
      beside.foreign_s / beside.seconds);
  std::printf(
      "the session's thread waited for a core, of each second: %.1f ms without the viewers, %.1f "
      "ms beside them\n",
      1e3 * without.session.waited / without.seconds, 1e3 * beside.session.waited / beside.seconds);
}

void print_shares(const Used& beside) {
  const double other = beside.busy.share();
  std::printf("of the time in which they could run, the busy processes ran %.1f %%\n", 100 * other);
  for (const auto& [name, time] : beside.threads) {
    if (time.ran < 0.001 * beside.seconds) continue;
    std::printf("  %-12s ran %5.1f %%, %.2f times as much; it used %.3f cores\n", name.c_str(),
                100 * time.share(), time.share() / other, time.ran / beside.seconds);
  }
}

/// Agents cut without and with viewers, in turn.
void run_turns(const Bench& bench, Raster& apart, Raster& watched) {
  const Options& options = bench.options;
  const int turns = std::max(2, static_cast<int>(std::ceil(options.seconds / kTurnS)));
  const auto samples = static_cast<std::uint64_t>(1000 * options.seconds / turns);
  Used without, beside;
  std::vector<double> ratios, memory_mb{bench.server.memory_mb()};
  const Downloads downloads(bench.server.port(), options.busy > 0);
  for (int turn = 1; turn <= turns; ++turn) {
    std::printf("%d agents without the viewers:", options.agents);
    const double alone = bench.turn(apart, samples, without);
    std::printf("; beside them:");
    ratios.push_back(bench.turn(watched, samples, beside) / alone);
    std::printf("; p99 %.2f times\n", ratios.back());
    if (turn * 6 / turns > (turn - 1) * 6 / turns) memory_mb.push_back(bench.server.memory_mb());
  }
  const double p99 = at_share(without.trips_us, 0.99), p99_beside = at_share(beside.trips_us, 0.99);
  std::printf(
      "all turns: p99 %.0f us without, %.0f us beside %d viewers: %.2f times; of the "
      "turns, the median is %.2f times\n",
      p99, p99_beside, options.viewers, p99_beside / p99, median(ratios));
  print_memory(memory_mb);
  print_viewers(options, bench.crowd.report(), without, beside);
  if (options.busy == 0) return;
  print_shares(beside);
  std::printf("downloads of the surface meanwhile: %.1f a minute\n",
              60 * downloads.count() / (without.seconds + beside.seconds));
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  std::setvbuf(stdout, nullptr, _IOLBF, 4096);
  allow_many_files();
  const ServerProcess server(options.server);
  post(server.port(), "/v1/sessions?id=bench", scene_for(options.seconds));
  post(server.port(), "/v1/sessions?id=apart", scene_for(options.seconds));
  AnswerTimes answers;
  const auto start = Clock::now();
  const bool has_load = options.busy > 0;
  Crowd crowd({{server.port()}, options.viewers, options.lists, has_load}, answers);
  const BusyLoops busy(options.busy);
  std::atomic<bool> stop = false;
  std::jthread agent;
  if (options.agents == 0 && !options.calm) {
    agent = std::jthread([&] { change_tools(stop, server.port()); });
  }
  crowd.wait_for_all(options.viewers, 60);
  const double joined_s = std::chrono::duration<double>(Clock::now() - start).count();
  if (options.agents > 0) {
    Raster apart(server.port(), "apart", options.agents, nullptr);
    Raster watched(server.port(), "bench", options.agents, &answers);
    run_turns({options, server, crowd, busy}, apart, watched);
  } else {
    std::this_thread::sleep_until(in_seconds(options.seconds));
  }
  stop = true;
  const CrowdReport& report = crowd.report();
  std::printf(
      "%d viewers: %d joined within %.2f s, %d dropped; %.2f MB of text in %.2f s; server: %.2f s "
      "of CPU, %.0f MB at most\n",
      options.viewers, report.joined.load(), joined_s, report.dropped.load(),
      double(report.text_bytes) / 1e6, std::chrono::duration<double>(Clock::now() - start).count(),
      server.cpu_seconds(), server.peak_memory_mb());
  return report.joined == options.viewers && report.dropped == 0 ? 0 : 1;
}
