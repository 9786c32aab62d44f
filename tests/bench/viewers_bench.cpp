// SPDX-License-Identifier: Apache-2.0
// A crowd of viewers: a real kerf-server as a child process, viewers that join one session as fast
// as they can and read everything, and an agent that changes its tool all the time.
//
//   viewers_bench [--server PATH] [--viewers N] [--seconds S] [--agents N] [--calm] [--lists]
//
// Prints how many viewers joined and were dropped, the bytes of text that the server sent to all of
// them together, the time until the last welcome, and the server's CPU time and peak memory.
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
#include <charconv>
#include <chrono>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/wire/codec.h"
#include "tests/bench/live_client.h"
#include "tests/bench/raster_agent.h"

namespace {

using namespace kerf::wire;
using namespace kerf::bench;

constexpr std::string_view kScene = R"({"name": "bench",
  "stock": {"shape": "box", "min_mm": [-40, -40, -30], "max_mm": [40, 40, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60},
            {"id": 2, "shape": "flat", "diameter_mm": 6, "length_mm": 60}]})";

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

/// When the motions of the session were answered.
class AnswerTimes {
 public:
  /// All motions up to number `motions` of the session have been answered now.
  void answered(std::uint64_t motions) {
    const std::scoped_lock lock(mutex_);
    if (motions >= times_.size()) times_.resize(motions + 1, Clock::now());
  }
  /// Returns nullopt for a motion whose answer has not arrived.
  std::optional<Clock::time_point> of(std::uint64_t motion) const {
    const std::scoped_lock lock(mutex_);
    return motion < times_.size() ? std::optional(times_[motion]) : std::nullopt;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Clock::time_point> times_;  ///< by number of the motion
};

/// One viewer, read without blocking. A mesh frame is acknowledged as soon as it is complete.
class Viewer {
 public:
  Viewer(std::uint16_t port, int number, const Options& options, const AnswerTimes& answers)
      : socket_(port), answers_(answers) {
    put(upgrade_request("/v1/sessions/bench/view", "kerf.view.v1"));
    hello_ = R"({"type":"hello","name":"viewer )" + std::to_string(number) +
             (options.lists ? R"("})" : R"(","changes":true})");
  }

  int descriptor() const { return socket_.descriptor(); }
  bool joined() const { return joined_; }
  bool dropped() const { return dropped_; }
  std::uint64_t text_bytes() const { return text_bytes_; }
  std::uint64_t mesh_bytes() const { return mesh_bytes_; }
  std::uint64_t mesh_frames() const { return mesh_frames_; }
  const std::vector<double>& stale_ms() const { return stale_ms_; }

  /// Reads what has arrived; returns false once the server has closed the connection.
  bool read_some() {
    std::array<char, 65536> chunk{};
    const ssize_t count = recv(descriptor(), chunk.data(), chunk.size(), MSG_DONTWAIT);
    if (count < 0 && errno == EAGAIN) return true;
    if (count <= 0) dropped_ = true;
    if (dropped_) return false;
    in_.append(chunk.data(), static_cast<std::size_t>(count));
    if (!hello_.empty()) {
      const auto end = in_.find("\r\n\r\n");
      if (end == std::string::npos) return true;
      dropped_ = in_.compare(9, 3, "101") != 0;
      if (dropped_) return false;
      in_.erase(0, end + 4);
      put_frame(1, std::exchange(hello_, {}));
    }
    while (take_frame()) continue;
    return true;
  }

 private:
  void put(const std::string& bytes) {
    if (::send(descriptor(), bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0) dropped_ = true;
  }
  void put_frame(unsigned char opcode, std::string_view payload) {
    std::string frame = {static_cast<char>(0x80 | opcode),
                         static_cast<char>(0x80 | payload.size())};
    put(frame.append(4, '\0').append(payload));
  }
  bool take_frame() {
    const auto at = [&](std::size_t i) { return static_cast<unsigned char>(in_[i]); };
    if (in_.size() < 10) return false;  // no frame is as short as that
    std::size_t head = 2, size = at(1) & 0x7FU;
    if (size >= 126) {
      const std::size_t bytes = size == 126 ? 2 : 8;
      size = 0;
      for (; head < 2 + bytes; ++head) size = size << 8 | at(head);
    }
    if (in_.size() < head + size) return false;
    const auto opcode = static_cast<unsigned char>(at(0) & 0x0FU);
    if (opcode == 1) {
      text_bytes_ += size;
      joined_ = joined_ || in_.find(R"("type":"welcome")", head) < head + size;
    } else if (opcode == 2) {
      acknowledge(std::as_bytes(std::span(in_)).subspan(head, size));
    } else if (opcode == 9) {
      put_frame(10, std::string_view(in_).substr(head, size));
    }
    in_.erase(0, head + size);
    return true;
  }
  void acknowledge(std::span<const std::byte> frame) {
    const auto message = decode(frame);
    if (!message || !std::holds_alternative<MeshView>(message->body)) return;
    std::vector<std::byte> ack;
    append(ack, {kNewEpoch, message->header.stamp.sequence, 0}, Ack{});
    put_frame(2, {reinterpret_cast<const char*>(ack.data()), ack.size()});
    ++mesh_frames_;
    mesh_bytes_ += frame.size();
    note_motions(frame, message->header.flags != 0);
  }
  /// Reads which motions a frame adds.
  void note_motions(std::span<const std::byte> frame, bool is_first_snapshot) {
    const std::string_view text{reinterpret_cast<const char*>(frame.data()), frame.size()};
    const std::size_t at = text.find("\"to\":");
    if (at == text.npos) fail("a mesh frame does not state its motions");
    std::uint64_t motions = 0;
    std::from_chars(text.data() + at + 5, text.data() + text.size(), motions);
    const auto oldest = answers_.of(std::exchange(motions_, motions) + 1);
    if (is_first_snapshot || motions == 0 || !oldest) return;
    stale_ms_.push_back(std::chrono::duration<double, std::milli>(Clock::now() - *oldest).count());
  }

  Socket socket_;
  const AnswerTimes& answers_;
  std::uint64_t mesh_bytes_ = 0, mesh_frames_ = 0, motions_ = 0;
  std::vector<double> stale_ms_;
  std::string hello_, in_;
  bool joined_ = false, dropped_ = false;
  std::uint64_t text_bytes_ = 0;
};

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

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;  // the server inherits it
  setrlimit(RLIMIT_NOFILE, &files);
  const ServerProcess server(options.server);
  post(server.port(), "/v1/sessions?id=bench", std::string(kScene));
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
    viewers.push_back(std::make_unique<Viewer>(server.port(), n, options, raster.answers()));
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
  serve(poller, viewers, in_seconds(options.seconds), false);
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
