// SPDX-License-Identifier: Apache-2.0
// Measures the turnaround of motions: a real kerf-server as a child process, one agent at 1 kHz
// over loopback, a ball of 10 mm that cuts without pause at 0.1 mm pitch.
//
//   turnaround_bench [--server PATH] [--seconds S] [--pitch MM] [--program] [--export NAME]
//                    [--agents N] [--viewers N] [--hostile]
//
// Prints percentiles of two times: in the server, from a motion frame read to its result encoded
// (reported in every result), and at the client, from sending the frame to receiving its result.
//
// --program    the server carves an uploaded program at full speed at the same time
// --export     the block first gets a rough surface; then a client downloads NAME (model.stl,
//              "model.glb?encoding=meshopt", ...) repeatedly while the agent cuts, and the server's
//              peak memory is printed before and after
// --agents N   N agents cut at the same time, each with its own thread; the last row is the agent
//              with the worst p99
// --viewers N  adds viewers that read everything
// --hostile    adds an agent that sends at full speed, half of it malformed, and reads nothing
//
// Agents request stock frames, as kerf-agent does, and acknowledge them.
#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "server/wire/codec.h"
#include "tests/bench/live_client.h"
#include "tests/bench/raster_agent.h"

namespace {

using namespace kerf::wire;
using namespace kerf::bench;

struct Options {
  std::string server = KERF_SERVER_PROGRAM;
  double seconds = 20, pitch_mm = 0.1;
  bool program = false, hostile = false;
  int agents = 1, viewers = 0;
  std::string download;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--program") {
      options.program = true;
    } else if (name == "--hostile") {
      options.hostile = true;
    } else if (i + 1 < argc && name == "--agents") {
      options.agents = std::clamp(std::atoi(argv[++i]), 1, 31);
    } else if (i + 1 < argc && name == "--viewers") {
      options.viewers = std::clamp(std::atoi(argv[++i]), 0, 64);
    } else if (i + 1 < argc && name == "--server") {
      options.server = argv[++i];
    } else if (i + 1 < argc && name == "--seconds") {
      options.seconds = std::atof(argv[++i]);
    } else if (i + 1 < argc && name == "--export") {
      options.download = argv[++i];
    } else if (i + 1 < argc && name == "--pitch") {
      options.pitch_mm = std::atof(argv[++i]);
    } else {
      fail("unknown option " + name);
    }
  }
  return options;
}

/// Totals of the repeated downloads.
struct Downloads {
  int count = 0;
  std::uint64_t bytes = 0;  ///< of the last download
  double seconds = 0;       ///< of all downloads
};

Downloads download_until(const std::atomic<bool>& stop, std::uint16_t port,
                         const std::string& name) {
  Downloads downloads;
  const auto start = Clock::now();
  while (!stop) {
    const Socket socket(port);
    const std::string request = "GET /v1/sessions/bench/" + name +
                                " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
    socket.send_all(request.data(), request.size());
    std::string answer;
    std::size_t end = 0;
    while ((end = answer.find("\r\n\r\n")) == std::string::npos) {
      socket.receive(answer, in_seconds(120));
    }
    if (answer.compare(9, 3, "200") != 0) fail(name + ": " + answer);
    downloads.bytes =
        std::strtoull(answer.c_str() + answer.find("Content-Length: ") + 16, nullptr, 10);
    for (std::uint64_t got = answer.size() - end - 4; got < downloads.bytes;) {
      answer.clear();
      socket.receive(answer, in_seconds(120));
      got += answer.size();
    }
    ++downloads.count;
  }
  downloads.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return downloads;
}

void print_row(const char* name, std::vector<double>& times_us) {
  if (times_us.empty()) return;
  std::sort(times_us.begin(), times_us.end());
  const auto at = [&](double share) {
    const auto last = static_cast<double>(times_us.size() - 1);
    return times_us[static_cast<std::size_t>(std::ceil(share * last))];
  };
  std::printf("%-34s %8.0f %8.0f %8.0f %8.0f\n", name, at(0.5), at(0.99), at(0.999),
              times_us.back());
}

struct Figures {
  std::vector<double> server_us, client_us;
  std::uint64_t late = 0, errors = 0, cutting = 0, stock_bytes = 0;
  double removed_mm3 = 0;
};

/// Acknowledges a stock frame like an agent with a replica, so that more are sent.
void take_stock(WebSocket& agent, const Message& message, std::size_t bytes, Figures& figures) {
  figures.stock_bytes += bytes;
  std::vector<std::byte> ack;
  append(ack, {kNewEpoch, message.header.stamp.sequence, 0}, Ack{});
  agent.send(2, ack);
}

void take_frame(WebSocket& agent, unsigned char opcode, const std::string& payload,
                const std::vector<Clock::time_point>& sent, Figures& figures) {
  if (opcode == 1 && payload.find("\"error\"") != std::string::npos) {
    if (figures.errors++ == 0) std::fprintf(stderr, "%s\n", payload.c_str());
  }
  if (opcode != 2) return;
  const auto message = decode(std::as_bytes(std::span(payload)));
  if (!message) fail("a frame of the server is malformed");
  if (std::holds_alternative<StockPatch>(message->body)) {
    return take_stock(agent, *message, payload.size(), figures);
  }
  const auto* result = std::get_if<Result>(&message->body);
  if (result == nullptr) return;
  const auto now = Clock::now();
  figures.server_us.push_back(result->turnaround_us);
  figures.client_us.push_back(
      std::chrono::duration<double, std::micro>(now - sent.at(result->agent_sequence)).count());
  figures.removed_mm3 += static_cast<double>(result->removed_mm3);
  figures.cutting += (result->status & kStatusCutting) != 0 ? 1 : 0;
}

Figures measure(WebSocket& agent, double seconds, std::uint64_t ahead) {
  Figures figures;
  const auto count = static_cast<std::uint64_t>(seconds * 1000);
  std::vector<Clock::time_point> sent(count + 1);
  std::string payload;
  std::vector<std::byte> frame;
  const auto start = Clock::now();
  for (std::uint64_t n = 1; n <= count; ++n) {
    const auto tick = start + std::chrono::milliseconds(n);
    while (Clock::now() < tick) {
      if (const auto opcode = agent.receive(payload, tick))
        take_frame(agent, opcode, payload, sent, figures);
    }
    if (Clock::now() > tick + std::chrono::milliseconds(1)) ++figures.late;
    MotionBatch batch{.count = 1};
    batch.samples[0] = sample_at(n, ahead);
    frame.clear();
    append(frame, {kNewEpoch, n, n * 1000}, batch);
    sent[n] = Clock::now();
    agent.send(2, frame);
  }
  while (const auto opcode = agent.receive(payload, in_seconds(0.5))) {
    take_frame(agent, opcode, payload, sent, figures);
  }
  return figures;
}

std::string scene(double pitch_mm) {
  return R"({"name":"bench","stock":{"shape":"box","min_mm":[-50,-50,-50],"max_mm":[50,50,0]},
    "accuracy":{"rays":"dexel","pitch_mm":)" +
         std::to_string(pitch_mm) + R"(,"tolerance_mm":0.01,"motion":"tight"},
    "tools":[{"id":1,"shape":"ball","diameter_mm":10,"length_mm":60}]})";
}

/// Cuts a raster over the whole top, so that no flat part remains whose triangles could be merged.
std::string raster_program() {
  std::string text = "G21 G90 T1 M6\nG0 X-50 Y-50 Z5\n";
  for (int row = 0; row <= 100; ++row) {
    text += "G1 Y" + std::to_string(row - 50) + " Z-0.9 F3000\nG1 X" +
            (row % 2 == 0 ? "50" : "-50") + "\n";
  }
  return text + "M2\n";
}

void wait_for_programs(std::uint16_t port) {
  for (std::string answer; answer.find("\"finished\"") == std::string::npos;) {
    const Socket socket(port);
    const std::string request =
        "GET /v1/sessions/bench/programs HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
    socket.send_all(request.data(), request.size());
    answer.clear();
    while (answer.find("\"programs\"") == std::string::npos ||
           answer.find("}]}") == std::string::npos) {
      if (!socket.receive(answer, in_seconds(10))) break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
}

std::string long_program() {
  std::string text = "G21 G90 T1 M6\n";
  for (int i = 0; i < 200'000; ++i) {
    text += "G1 X" + std::to_string((i % 80) - 40) + " Y" + std::to_string((i / 80) % 80 - 40) +
            " Z" + std::to_string(-20 - i / 6400) + " F3000\n";
  }
  return text + "M2\n";
}

void run_viewer(const std::atomic<bool>& stop, std::uint16_t port) {
  WebSocket viewer = join(port, "view", kViewProtocol);
  std::string payload;
  std::vector<std::byte> ack;
  while (!stop) {
    if (viewer.receive(payload, in_seconds(0.1)) != 2) continue;
    const auto message = decode(std::as_bytes(std::span(payload)));
    if (!message || !std::holds_alternative<MeshView>(message->body)) continue;
    ack.clear();
    append(ack, {kNewEpoch, message->header.stamp.sequence, 0}, Ack{});
    viewer.send(2, ack);
  }
}

void run_hostile_agent(const std::atomic<bool>& stop, std::uint16_t port) {
  WebSocket agent = join(port, "agent", kAgentProtocol);
  std::vector<std::byte> frame;
  for (std::uint64_t n = 1; !stop; ++n) {
    MotionBatch batch{.count = 1};
    batch.samples[0] = sample_at(n, 20'000);
    frame.clear();
    append(frame, {kNewEpoch, n, n * 1000}, batch);
    if (n % 2 == 0) frame[40] = std::byte{0xFF};
    if (!agent.try_send(2, frame)) return;  // disconnected, as expected
  }
}

/// Runs several agents; the last entry is the agent with the worst p99 of the server's time.
std::vector<Figures> measure_all(const Options& options, std::uint16_t port) {
  const auto count = static_cast<std::size_t>(options.agents);
  std::vector<Figures> all(count);
  std::vector<WebSocket> agents;
  for (std::size_t i = 0; i < count; ++i) agents.push_back(join_agent(port));
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < count; ++i) {
      threads.emplace_back(
          [&, i] { all[i] = measure(agents[i], options.seconds, i * kLayer / count); });
    }
  }
  const auto p99 = [](const Figures& figures) {
    std::vector<double> times = figures.server_us;
    if (times.empty()) return 0.0;
    std::sort(times.begin(), times.end());
    return times[times.size() * 99 / 100];
  };
  std::sort(all.begin(), all.end(),
            [&](const Figures& a, const Figures& b) { return p99(a) < p99(b); });
  return all;
}

Figures sum_of(const std::vector<Figures>& all) {
  Figures sum;
  for (const Figures& f : all) {
    sum.server_us.insert(sum.server_us.end(), f.server_us.begin(), f.server_us.end());
    sum.client_us.insert(sum.client_us.end(), f.client_us.begin(), f.client_us.end());
    sum.late += f.late;
    sum.errors += f.errors;
    sum.stock_bytes += f.stock_bytes;
    sum.cutting += f.cutting;
    sum.removed_mm3 += f.removed_mm3;
  }
  return sum;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  const ServerProcess server(options.server);
  post(server.port(), "/v1/sessions?id=bench", scene(options.pitch_mm));
  if (options.program) {
    post(server.port(), "/v1/sessions/bench/programs?pace=fast&name=load.ngc", long_program());
  }
  if (!options.download.empty()) {
    post(server.port(), "/v1/sessions/bench/programs?pace=fast&name=r.ngc", raster_program());
    wait_for_programs(server.port());
  }
  std::atomic<bool> stop = false;
  Downloads downloads;
  std::thread client;
  const double before_mb = server.peak_memory_mb();
  if (!options.download.empty()) {
    client =
        std::thread([&] { downloads = download_until(stop, server.port(), options.download); });
  }
  std::vector<std::thread> others;
  for (int i = 0; i < options.viewers; ++i) {
    others.emplace_back([&] { run_viewer(stop, server.port()); });
  }
  if (options.hostile) others.emplace_back([&] { run_hostile_agent(stop, server.port()); });
  std::vector<Figures> all = measure_all(options, server.port());
  Figures figures = sum_of(all);
  stop = true;
  for (std::thread& other : others) other.join();
  if (client.joinable()) client.join();
  std::printf("pitch %g mm, ball 10 mm, %.0f s at 1 kHz, %d agents, %d viewers%s%s\n",
              options.pitch_mm, options.seconds, options.agents, options.viewers,
              options.program ? ", and a program" : "",
              options.hostile ? ", and a hostile agent" : "");
  std::printf("%zu results, %llu of them cutting, %.0f mm3 removed, %llu errors, %llu late ticks\n",
              figures.server_us.size(), static_cast<unsigned long long>(figures.cutting),
              figures.removed_mm3, static_cast<unsigned long long>(figures.errors),
              static_cast<unsigned long long>(figures.late));
  std::printf("%.1f kB/s of columns to each agent, for its replica\n",
              double(figures.stock_bytes) / 1e3 / options.seconds / options.agents);
  std::printf("%-34s %8s %8s %8s %8s\n", "us", "p50", "p99", "p99.9", "max");
  print_row("server: frame read to result sent", figures.server_us);
  print_row("client: round trip over loopback", figures.client_us);
  if (options.agents > 1) print_row("server: agent with the worst p99", all.back().server_us);
  if (downloads.count > 0) {
    std::printf(
        "%d downloads of %s in %.1f s, the last of %.1f MB (as STL: %.2f million triangles); "
        "the server's peak memory was %.1f MB before and %.1f MB after\n",
        downloads.count, options.download.c_str(), downloads.seconds, double(downloads.bytes) / 1e6,
        double(downloads.bytes) / 50e6, before_mb, server.peak_memory_mb());
  }
  return figures.server_us.empty() || figures.errors > 0 ? 1 : 0;
}
