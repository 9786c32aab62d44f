// SPDX-License-Identifier: Apache-2.0
// A crowd of viewers: a real kerf-server as a child process, viewers that join one session as fast
// as they can and read everything, and an agent that changes its tool all the time.
//
//   viewers_bench [--server PATH] [--viewers N] [--seconds S] [--agents N] [--calm] [--lists]
//
// Prints how many viewers joined and were dropped, the bytes of text that the server sent to all of
// them together, the time until the last welcome, and the server's CPU time and memory.
//
// --seconds S  keeps the viewers for S seconds after the last welcome (default 3)
// --agents N   instead of the agent that changes its tool, N agents cut a raster at 1 kHz, for S
//              seconds alone and then beside the viewers. Prints their round trips in both phases,
//              the mesh frames and bytes to each viewer, the server's CPU time for each, and the
//              staleness of the frames: the time from the answer to a motion to its agent until a
//              viewer has a frame that includes it, of the oldest motion that each frame adds.
//              Prints also the cores that the server and these clients use. All share one machine,
//              so the viewers here have niceness 5, and the agents SCHED_FIFO, if that is allowed,
//              as kerf-agent has.
// --calm       no agent
// --lists      the viewers do not know 'participants_changed' and get complete lists
#include <sched.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/wire/codec.h"
#include "tests/bench/crowd_viewer.h"
#include "tests/bench/live_client.h"
#include "tests/bench/raster_agent.h"

namespace {

using namespace kerf::wire;
using namespace kerf::bench;

struct Options {
  std::string server = KERF_SERVER_PROGRAM;
  int viewers = 1000, agents = 0;
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
      options.agents = std::clamp(std::atoi(argv[++i]), 0, 31);
    } else if (word == "--seconds" && has_value) {
      options.seconds = std::atof(argv[++i]);
    } else {
      fail("unknown option " + std::string(word));
    }
  }
  return options;
}

/// A block that is high enough for all layers of a raster of twice so many seconds.
std::string scene_for(double seconds) {
  const double layers = std::ceil(2000 * seconds / double(kLayer)) + 2;
  return R"({"name": "bench",
  "stock": {"shape": "box", "min_mm": [-40, -40, )" +
         std::to_string(-30 - kDownMm * layers) + R"(], "max_mm": [40, 40, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60},
            {"id": 2, "shape": "flat", "diameter_mm": 6, "length_mm": 60}]})";
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

/// Cuts the raster at 1 kHz from sample `first` to `end`; returns the round trips, us.
std::vector<double> cut_raster(WebSocket& agent, std::uint64_t first, std::uint64_t end,
                               std::uint64_t ahead, AnswerTimes& answers) {
  std::vector<double> trips_us;
  std::vector<Clock::time_point> sent(end);
  std::string payload;
  std::vector<std::byte> frame;
  const auto take = [&](Clock::time_point until) {
    const auto opcode = agent.receive(payload, until);
    if (opcode != 2) return opcode != 0;
    const auto message = decode(std::as_bytes(std::span(payload)));
    if (!message) fail("a frame of the server is malformed");
    if (const auto* result = std::get_if<Result>(&message->body)) {
      answers.answered(result->motions_applied);
      trips_us.push_back(
          std::chrono::duration<double, std::micro>(Clock::now() - sent.at(result->agent_sequence))
              .count());
    } else if (std::holds_alternative<StockPatch>(message->body)) {
      frame.clear();
      append(frame, {kNewEpoch, message->header.stamp.sequence, 0}, Ack{});
      agent.send(2, frame);
    }
    return true;
  };
  const auto start = Clock::now();
  for (std::uint64_t n = first; n < end; ++n) {
    const auto tick = start + std::chrono::milliseconds(n - first);
    while (Clock::now() < tick) take(tick);
    MotionBatch batch;
    batch.count = 1;
    batch.samples[0] = sample_at(n, ahead);
    frame.clear();
    append(frame, {kNewEpoch, n, n * 1000}, batch);
    sent[n] = Clock::now();
    agent.send(2, frame);
  }
  while (take(in_seconds(0.5))) continue;
  return trips_us;
}

double at_share(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * double(values.size() - 1))];
}

/// The agents of --agents.
class Raster {
 public:
  Raster(std::uint16_t port, int agents, double seconds)
      : count_(static_cast<std::uint64_t>(seconds * 1000)) {
    for (int n = 0; n < agents; ++n) agents_.push_back(join_agent(port));
  }
  AnswerTimes& answers() { return answers_; }
  /// Cuts for the seconds of the constructor and prints the round trips.
  void cut(const char* when) {
    std::vector<std::vector<double>> trips(agents_.size());
    {
      std::vector<std::jthread> threads;
      for (std::size_t n = 0; n < agents_.size(); ++n) {
        threads.emplace_back([&, n] {
          const sched_param priority{.sched_priority = 60};
          sched_setscheduler(0, SCHED_FIFO, &priority);
          trips[n] = cut_raster(agents_[n], 1 + phase_ * count_, 1 + (phase_ + 1) * count_,
                                n * kLayer / agents_.size(), answers_);
        });
      }
    }
    ++phase_;
    std::vector<double> all;
    for (const auto& some : trips) all.insert(all.end(), some.begin(), some.end());
    std::printf("%zu agents %s: round trip p50 %.0f us, p99 %.0f us\n", agents_.size(), when,
                at_share(all, 0.5), at_share(all, 0.99));
  }

 private:
  std::vector<WebSocket> agents_;
  AnswerTimes answers_;
  std::uint64_t count_, phase_ = 0;
};

/// CPU time that this process, or the calling thread of it (RUSAGE_THREAD), has used, s.
double used_cpu_s(int who) {
  rusage usage{};
  getrusage(static_cast<__rusage_who_t>(who), &usage);
  const auto seconds = [](const timeval& time) {
    return double(time.tv_sec) + 1e-6 * double(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// CPU time of the server, of the clients that are viewers and of all clients, s.
struct CpuTimes {
  double server = 0, viewers = 0, clients = 0;
};
CpuTimes cpu_times(const ServerProcess& server) {
  return {server.cpu_seconds(), used_cpu_s(RUSAGE_THREAD), used_cpu_s(RUSAGE_SELF)};
}

/// Serves the viewers until `until`, or until all have joined or been dropped.
void serve(int poller, std::vector<std::unique_ptr<Viewer>>& viewers, Clock::time_point until,
           bool only_joins) {
  std::array<epoll_event, 256> events{};
  do {
    const int wait_ms = Clock::now() < until ? 10 : 0;
    const int count = epoll_wait(poller, events.data(), events.size(), wait_ms);
    for (int i = 0; i < count; ++i) {
      Viewer& viewer = *static_cast<Viewer*>(events.at(static_cast<std::size_t>(i)).data.ptr);
      if (!viewer.read_some()) epoll_ctl(poller, EPOLL_CTL_DEL, viewer.descriptor(), nullptr);
    }
    const bool all = std::ranges::all_of(
        viewers, [](const auto& viewer) { return viewer->joined() || viewer->dropped(); });
    if (only_joins && all) return;
  } while (Clock::now() < until);
}

/// Serves the viewers for some seconds; returns the server's memory before and after each sixth.
std::vector<double> serve_in_sixths(int poller, std::vector<std::unique_ptr<Viewer>>& viewers,
                                    double seconds, const ServerProcess& server) {
  std::vector<double> memory_mb{server.memory_mb()};
  for (int part = 0; part < 6; ++part) {
    serve(poller, viewers, in_seconds(seconds / 6), false);
    memory_mb.push_back(server.memory_mb());
  }
  return memory_mb;
}

void print_memory(const std::vector<double>& memory_mb) {
  std::printf("the server's memory then, and after each sixth of the time:");
  for (const double mb : memory_mb) std::printf(" %.1f", mb);
  std::printf(" MB\n");
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;  // the server inherits it
  setrlimit(RLIMIT_NOFILE, &files);
  const ServerProcess server(options.server);
  post(server.port(), "/v1/sessions?id=bench", scene_for(options.seconds));
  std::atomic<bool> stop = false;
  std::thread agent;
  Raster raster(server.port(), options.agents, options.seconds);
  if (options.agents > 0) {
    raster.cut("alone");
  } else if (!options.calm) {
    agent = std::thread([&] { change_tools(stop, server.port()); });
  }
  const int poller = epoll_create1(EPOLL_CLOEXEC);
  std::vector<std::unique_ptr<Viewer>> viewers;
  const auto start = Clock::now();
  for (int n = 0; n < options.viewers; ++n) {
    viewers.push_back(std::make_unique<Viewer>(server.port(), n, options.lists, raster.answers()));
    epoll_event event{.events = EPOLLIN, .data = {.ptr = viewers.back().get()}};
    epoll_ctl(poller, EPOLL_CTL_ADD, viewers.back()->descriptor(), &event);
    serve(poller, viewers, Clock::now(), true);
  }
  serve(poller, viewers, in_seconds(60), true);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  if (options.agents > 0) {
    agent = std::thread([&] { raster.cut("beside the viewers"); });
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 5);  // of this thread
  }
  const CpuTimes before = cpu_times(server);
  const std::vector<double> memory_mb = serve_in_sixths(poller, viewers, options.seconds, server);
  const CpuTimes after = cpu_times(server);
  const double cpu = after.server - before.server;
  const auto joined = std::ranges::count_if(viewers, [](const auto& v) { return v->joined(); });
  const auto dropped = std::ranges::count_if(viewers, [](const auto& v) { return v->dropped(); });
  std::uint64_t text = 0, mesh = 0, frames = 0;
  std::vector<double> stale_ms;
  for (const auto& viewer : viewers) {
    text += viewer->text_bytes();
    mesh += viewer->mesh_bytes();
    frames += viewer->mesh_frames();
    stale_ms.insert(stale_ms.end(), viewer->stale_ms().begin(), viewer->stale_ms().end());
  }
  stop = true;
  if (agent.joinable()) agent.join();
  std::printf(
      "%d viewers: %td joined within %.2f s, %td dropped; %.2f MB of text in %.2f s; server: %.2f "
      "s of CPU, %.0f MB at most\n",
      options.viewers, joined, seconds, dropped, double(text) / 1e6, seconds + options.seconds,
      server.cpu_seconds(), server.peak_memory_mb());
  print_memory(memory_mb);
  if (options.agents > 0) {
    const double each = 1.0 / options.viewers;
    std::printf(
        "each viewer: %.1f mesh frames/s, %.0f kB/s; staleness p50 %.0f ms, p99 %.0f ms; server: "
        "%.2f ms of CPU per second and viewer, that of the agents included\n",
        double(frames) * each / options.seconds, double(mesh) * each / options.seconds / 1e3,
        at_share(stale_ms, 0.5), at_share(stale_ms, 0.99), 1e3 * cpu * each / options.seconds);
    const double viewers_s = after.viewers - before.viewers;
    std::printf("cores used: server %.2f, the bench's viewers %.2f, its agents %.2f\n",
                cpu / options.seconds, viewers_s / options.seconds,
                (after.clients - before.clients - viewers_s) / options.seconds);
  }
  close(poller);
  return joined == options.viewers && dropped == 0 ? 0 : 1;
}
