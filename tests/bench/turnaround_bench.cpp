// From motion in to wrench out: a real kerf-server as a child process, one agent at 1 kHz over
// loopback, a ball of 10 mm that cuts without pause at 0.1 mm pitch.
//
//   turnaround_bench [--server PATH] [--seconds S] [--pitch MM] [--program]
//
// Prints percentiles of two times: in the server, from a motion frame read to its wrench encoded
// (every result carries it), and at the client, from sending the frame to receiving its result.
// With --program, the server carves an uploaded program as fast as it can at the same time.
#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "server/wire/codec.h"

extern char** environ;

namespace {

using namespace kerf::wire;
using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "turnaround_bench: %s\n", what.c_str());
  std::exit(1);
}

struct Options {
  std::string server = KERF_SERVER_PROGRAM;
  double seconds = 20, pitch_mm = 0.1;
  bool program = false;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--program") {
      options.program = true;
    } else if (i + 1 < argc && name == "--server") {
      options.server = argv[++i];
    } else if (i + 1 < argc && name == "--seconds") {
      options.seconds = std::atof(argv[++i]);
    } else if (i + 1 < argc && name == "--pitch") {
      options.pitch_mm = std::atof(argv[++i]);
    } else {
      fail("unknown option " + name);
    }
  }
  return options;
}

/// The server as a child, with a data folder of its own.
class ServerProcess {
 public:
  explicit ServerProcess(const std::string& program) {
    std::string name = (std::filesystem::temp_directory_path() / "kerf-bench-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    std::array<int, 2> out{};
    if (pipe(out.data()) != 0) fail("no pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
    posix_spawn_file_actions_addclose(&actions, out[0]);
    const std::string data = folder_.string();
    std::vector<std::string> words = {program, "--listen", "127.0.0.1:0", "--data", data};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (posix_spawn(&pid_, program.c_str(), &actions, nullptr, arguments.data(), environ) != 0) {
      fail("cannot start " + program);
    }
    posix_spawn_file_actions_destroy(&actions);
    close(out[1]);
    std::array<char, 256> line{};
    const ssize_t count = read(out[0], line.data(), line.size() - 1);
    const char* colon = count > 0 ? std::strrchr(line.data(), ':') : nullptr;
    if (colon == nullptr) fail("the server did not print its address");
    port_ = static_cast<std::uint16_t>(std::atoi(colon + 1));
  }
  ~ServerProcess() {
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
    std::filesystem::remove_all(folder_);
  }
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;
  std::uint16_t port() const { return port_; }

 private:
  std::filesystem::path folder_;
  pid_t pid_ = 0;
  std::uint16_t port_ = 0;
};

class Socket {
 public:
  explicit Socket(std::uint16_t port) : descriptor_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
      fail("cannot connect");
    }
    const int on = 1;
    setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
  ~Socket() { close(descriptor_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  void send_all(const void* data, std::size_t size) const {
    const auto* bytes = static_cast<const char*>(data);
    while (size > 0) {
      const ssize_t sent = send(descriptor_, bytes, size, MSG_NOSIGNAL);
      if (sent <= 0) fail("the connection broke");
      bytes += sent;
      size -= static_cast<std::size_t>(sent);
    }
  }
  /// Waits until `until` for more bytes behind `buffer`'s end; false if there are none.
  bool receive(std::string& buffer, Clock::time_point until) const {
    const auto wait = std::chrono::ceil<std::chrono::nanoseconds>(until - Clock::now()).count();
    const timespec limit{wait > 0 ? wait / 1'000'000'000 : 0, wait > 0 ? wait % 1'000'000'000 : 0};
    pollfd events{descriptor_, POLLIN, 0};
    if (ppoll(&events, 1, &limit, nullptr) <= 0) return false;
    std::array<char, 16384> chunk{};
    const ssize_t count = recv(descriptor_, chunk.data(), chunk.size(), 0);
    if (count <= 0) fail("the server closed the connection");
    buffer.append(chunk.data(), static_cast<std::size_t>(count));
    return true;
  }

 private:
  int descriptor_;
};

Clock::time_point in_seconds(double seconds) {
  return Clock::now() + std::chrono::microseconds(static_cast<std::int64_t>(seconds * 1e6));
}

void post(std::uint16_t port, const std::string& path, const std::string& body) {
  const Socket socket(port);
  const std::string request = "POST " + path + " HTTP/1.1\r\nHost: bench\r\nConnection: close\r\n" +
                              "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
  socket.send_all(request.data(), request.size());
  std::string answer;
  while (answer.find("\r\n") == std::string::npos) socket.receive(answer, in_seconds(60));
  if (answer.compare(9, 2, "20") != 0) fail(path + ": " + answer);
}

/// The client's half of a WebSocket, as far as this program needs it.
class WebSocket {
 public:
  WebSocket(std::uint16_t port, const std::string& path, const std::string& protocol)
      : socket_(port) {
    const std::string request =
        "GET " + path +
        " HTTP/1.1\r\nHost: bench\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" +
        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n" +
        "Sec-WebSocket-Protocol: " + protocol + "\r\n\r\n";
    socket_.send_all(request.data(), request.size());
    std::size_t end = 0;
    while ((end = buffer_.find("\r\n\r\n")) == std::string::npos) {
      socket_.receive(buffer_, in_seconds(10));
    }
    if (buffer_.compare(9, 3, "101") != 0) fail(buffer_);
    buffer_.erase(0, end + 4);
  }
  /// A mask of zero is legal and leaves the payload as it is.
  void send(unsigned char opcode, std::span<const std::byte> payload) {
    frame_.assign(1, static_cast<char>(0x80 | opcode));
    if (payload.size() < 126) {
      frame_.push_back(static_cast<char>(0x80 | payload.size()));
    } else {
      frame_.push_back(static_cast<char>(0x80 | 126));
      frame_.push_back(static_cast<char>(payload.size() >> 8));
      frame_.push_back(static_cast<char>(payload.size() & 0xFF));
    }
    frame_.append(4, '\0');
    frame_.append(reinterpret_cast<const char*>(payload.data()), payload.size());
    socket_.send_all(frame_.data(), frame_.size());
  }
  /// The next frame's opcode and payload; 0 if none is complete by `until`.
  unsigned char receive(std::string& payload, Clock::time_point until) {
    for (;;) {
      if (const auto opcode = take(payload); opcode != 0) return opcode;
      if (!socket_.receive(buffer_, until)) return 0;
    }
  }

 private:
  unsigned char take(std::string& payload) {
    const auto at = [&](std::size_t i) { return static_cast<unsigned char>(buffer_[i]); };
    if (buffer_.size() < 2) return 0;
    std::size_t head = 2, size = at(1) & 0x7FU;
    if (size == 126) {
      if (buffer_.size() < 4) return 0;
      size = (std::size_t{at(2)} << 8) | at(3);
      head = 4;
    }
    if (buffer_.size() < head + size) return 0;
    const auto opcode = static_cast<unsigned char>(at(0) & 0x0FU);
    payload = buffer_.substr(head, size);
    buffer_.erase(0, head + size);
    return opcode;
  }

  Socket socket_;
  std::string buffer_, frame_;
};

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

/// A raster through fresh stock, 3 mm deep, at 50 mm/s: the tool never leaves the material.
MotionSample sample_at(std::uint64_t n) {
  constexpr double kStepMm = 0.05, kRowMm = 80, kStepOverMm = 4;
  const double way = static_cast<double>(n) * kStepMm;
  const double lap = kRowMm + kStepOverMm;
  const auto row = static_cast<int>(way / lap);
  const double along = way - row * lap;
  const double x = std::min(along, kRowMm);
  MotionSample sample;
  sample.agent_sequence = n;
  sample.time_us = n * 1000;
  sample.tip_mm = {row % 2 == 0 ? x - 40 : 40 - x,
                   std::fmod(row * kStepOverMm + std::max(0.0, along - kRowMm), 80) - 40,
                   -3.0 - 3 * std::floor(row * kStepOverMm / 80)};
  sample.tool_id = 1;
  sample.buttons = kButtonCutting;
  return sample;
}

struct Figures {
  std::vector<double> server_us, client_us;
  std::uint64_t late = 0, errors = 0, cutting = 0;
  double removed_mm3 = 0;
};

void take_frame(unsigned char opcode, const std::string& payload,
                const std::vector<Clock::time_point>& sent, Figures& figures) {
  if (opcode == 1 && payload.find("\"error\"") != std::string::npos) {
    if (figures.errors++ == 0) std::fprintf(stderr, "%s\n", payload.c_str());
  }
  if (opcode != 2) return;
  const auto message = decode(std::as_bytes(std::span(payload)));
  if (!message) fail("a frame of the server is malformed");
  const auto* result = std::get_if<Result>(&message->body);
  if (result == nullptr) return;
  const auto now = Clock::now();
  figures.server_us.push_back(result->turnaround_us);
  figures.client_us.push_back(
      std::chrono::duration<double, std::micro>(now - sent.at(result->agent_sequence)).count());
  figures.removed_mm3 += static_cast<double>(result->removed_mm3);
  figures.cutting += (result->status & kStatusCutting) != 0 ? 1 : 0;
}

Figures measure(WebSocket& agent, double seconds) {
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
        take_frame(opcode, payload, sent, figures);
    }
    if (Clock::now() > tick + std::chrono::milliseconds(1)) ++figures.late;
    MotionBatch batch;
    batch.count = 1;
    batch.samples[0] = sample_at(n);
    frame.clear();
    append(frame, {1, n, n * 1000}, batch);
    sent[n] = Clock::now();
    agent.send(2, frame);
  }
  while (const auto opcode = agent.receive(payload, in_seconds(0.5))) {
    take_frame(opcode, payload, sent, figures);
  }
  return figures;
}

std::string scene(double pitch_mm) {
  return R"({"name":"bench","stock":{"shape":"box","min_mm":[-50,-50,-50],"max_mm":[50,50,0]},
    "accuracy":{"rays":"dexel","pitch_mm":)" +
         std::to_string(pitch_mm) + R"(,"tolerance_mm":0.01,"motion":"tight"},
    "tools":[{"id":1,"shape":"ball","diameter_mm":10,"length_mm":60}]})";
}

std::string long_program() {
  std::string text = "G21 G90 T1 M6\n";
  for (int i = 0; i < 200'000; ++i) {
    text += "G1 X" + std::to_string((i % 80) - 40) + " Y" + std::to_string((i / 80) % 80 - 40) +
            " Z" + std::to_string(-20 - i / 6400) + " F3000\n";
  }
  return text + "M2\n";
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  const ServerProcess server(options.server);
  post(server.port(), "/v1/sessions?id=bench", scene(options.pitch_mm));
  if (options.program) {
    post(server.port(), "/v1/sessions/bench/programs?pace=fast&name=load.ngc", long_program());
  }
  WebSocket agent(server.port(), "/v1/sessions/bench/agent", std::string(kAgentProtocol));
  const std::string hello = R"({"type":"hello","name":"bench","tool":1,"feel":true})";
  agent.send(1, std::as_bytes(std::span(hello)));
  std::string payload;
  agent.receive(payload, in_seconds(10));
  if (payload.find("welcome") == std::string::npos) fail("no welcome: " + payload);

  Figures figures = measure(agent, options.seconds);
  std::printf("pitch %g mm, ball 10 mm, %.0f s at 1 kHz%s\n", options.pitch_mm, options.seconds,
              options.program ? ", a program carved beside" : "");
  std::printf("%zu results, %llu of them cutting, %.0f mm3 removed, %llu errors, %llu late ticks\n",
              figures.server_us.size(), static_cast<unsigned long long>(figures.cutting),
              figures.removed_mm3, static_cast<unsigned long long>(figures.errors),
              static_cast<unsigned long long>(figures.late));
  std::printf("%-34s %8s %8s %8s %8s\n", "us", "p50", "p99", "p99.9", "max");
  print_row("server: frame read to wrench out", figures.server_us);
  print_row("client: round trip over loopback", figures.client_us);
  return figures.server_us.empty() || figures.errors > 0 ? 1 : 0;
}
