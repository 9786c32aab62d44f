// SPDX-License-Identifier: Apache-2.0
// A crowd of viewers: a real kerf-server as a child process, viewers that join one session as fast
// as they can and read everything, and an agent that changes its tool all the time.
//
//   viewers_bench [--server PATH] [--viewers N] [--seconds S] [--calm] [--lists]
//
// Prints how many viewers joined and were dropped, the bytes of text that the server sent to all of
// them together, the time until the last welcome, and the server's CPU time and peak memory.
//
// --seconds S  keeps the viewers for S seconds after the last welcome (default 3)
// --calm       no agent
// --lists      the viewers do not know 'participants_changed' and get complete lists
#include <sys/epoll.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/wire/codec.h"
#include "tests/bench/live_client.h"

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
  int viewers = 1000;
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
    } else if (word == "--seconds" && has_value) {
      options.seconds = std::atof(argv[++i]);
    } else {
      fail("unknown option " + std::string(word));
    }
  }
  return options;
}

/// One viewer, read without blocking. A mesh frame is acknowledged as soon as it is complete.
class Viewer {
 public:
  Viewer(std::uint16_t port, int number, const Options& options) : socket_(port) {
    put(upgrade_request("/v1/sessions/bench/view", "kerf.view.v1"));
    hello_ = R"({"type":"hello","name":"viewer )" + std::to_string(number) +
             (options.lists ? R"("})" : R"(","changes":true})");
  }

  int descriptor() const { return socket_.descriptor(); }
  bool joined() const { return joined_; }
  bool dropped() const { return dropped_; }
  std::uint64_t text_bytes() const { return text_bytes_; }

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
    append(ack, {1, message->header.stamp.sequence, 0}, Ack{});
    put_frame(2, {reinterpret_cast<const char*>(ack.data()), ack.size()});
  }

  Socket socket_;
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
  if (!options.calm) agent = std::thread([&] { change_tools(stop, server.port()); });
  const int poller = epoll_create1(EPOLL_CLOEXEC);
  std::vector<std::unique_ptr<Viewer>> viewers;
  const auto start = Clock::now();
  for (int n = 0; n < options.viewers; ++n) {
    viewers.push_back(std::make_unique<Viewer>(server.port(), n, options));
    epoll_event event{.events = EPOLLIN, .data = {.ptr = viewers.back().get()}};
    epoll_ctl(poller, EPOLL_CTL_ADD, viewers.back()->descriptor(), &event);
    serve(poller, viewers, Clock::now(), true);
  }
  serve(poller, viewers, in_seconds(60), true);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  serve(poller, viewers, in_seconds(options.seconds), false);
  const auto joined = std::ranges::count_if(viewers, [](const auto& v) { return v->joined(); });
  const auto dropped = std::ranges::count_if(viewers, [](const auto& v) { return v->dropped(); });
  std::uint64_t bytes = 0;
  for (const auto& viewer : viewers) bytes += viewer->text_bytes();
  std::printf(
      "%d viewers: %td joined within %.2f s, %td dropped; %.2f MB of text in %.2f s; server: %.2f "
      "s of CPU, %.0f MB at most\n",
      options.viewers, joined, seconds, dropped, double(bytes) / 1e6, seconds + options.seconds,
      server.cpu_seconds(), server.peak_memory_mb());
  stop = true;
  if (agent.joinable()) agent.join();
  close(poller);
  return joined == options.viewers && dropped == 0 ? 0 : 1;
}
