// SPDX-License-Identifier: Apache-2.0
// Viewers at servers that follow a session: nats-server, an owner and its followers as child
// processes, agents that cut at the owner, and viewers divided among the followers.
//
//   relay_bench [--server PATH] [--nats PATH] [--relays N] [--viewers N] [--agents N] [--seconds S]
//
// Cuts for S seconds (10) without viewers and for as long with them, and prints the CPU time of the
// owner, of nats-server and of each follower in both; how many viewers joined and were dropped, the
// mesh frames to each, and the staleness of the frames: the time from the answer to a motion to its
// agent until a viewer at another server has a frame that includes it. All share one machine.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "tests/bench/crowd.h"
#include "tests/bench/live_client.h"
#include "tests/bench/raster.h"

namespace {

using namespace kerf::bench;

struct Options {
  std::string server = KERF_SERVER_PROGRAM, nats = "nats-server";
  int relays = 3, viewers = 300, agents = 1;
  double seconds = 10;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view word = argv[i];
    const char* value = argv[i + 1];
    if (word == "--server") {
      options.server = value;
    } else if (word == "--nats") {
      options.nats = value;
    } else if (word == "--relays") {
      options.relays = std::clamp(std::atoi(value), 1, 16);
    } else if (word == "--viewers") {
      options.viewers = std::clamp(std::atoi(value), 1, 20'000);
    } else if (word == "--agents") {
      options.agents = std::clamp(std::atoi(value), 1, 15);
    } else if (word == "--seconds") {
      options.seconds = std::atof(value);
    } else {
      fail("unknown option " + std::string(word));
    }
  }
  return options;
}

/// A nats-server with JetStream in a folder of its own.
class NatsProcess {
 public:
  explicit NatsProcess(const std::string& program) {
    std::string name = (std::filesystem::temp_directory_path() / "kerf-bench-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    port_ = 20'000 + getpid() % 20'000;
    pid_ = start_process([&] {
      const std::string port = std::to_string(port_);
      execlp(program.c_str(), program.c_str(), "-js", "-sd", folder_.c_str(), "-a", "127.0.0.1",
             "-p", port.c_str(), "-l", "/dev/null", nullptr);
      std::perror(program.c_str());
    });
  }
  ~NatsProcess() {
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
    std::filesystem::remove_all(folder_);
  }
  NatsProcess(const NatsProcess&) = delete;
  NatsProcess& operator=(const NatsProcess&) = delete;
  std::string url() const { return "nats://127.0.0.1:" + std::to_string(port_); }
  double cpu_seconds() const { return process_cpu_seconds(pid_); }

 private:
  std::filesystem::path folder_;
  int port_ = 0;
  pid_t pid_ = 0;
};

struct Servers {
  NatsProcess nats;
  std::unique_ptr<ServerProcess> owner;
  std::vector<std::unique_ptr<ServerProcess>> relays;

  explicit Servers(const Options& options) : nats(options.nats) {
    const auto words = [&](const std::string& name) {
      return std::vector<std::string>{"--nats", nats.url(), "--node", name, "--follow", "viewed"};
    };
    owner = std::make_unique<ServerProcess>(options.server, words("owner"));
    for (int n = 0; n < options.relays; ++n) {
      const auto name = "relay" + std::to_string(n);
      relays.push_back(std::make_unique<ServerProcess>(options.server, words(name)));
    }
  }
  std::vector<std::uint16_t> relay_ports() const {
    std::vector<std::uint16_t> ports;
    for (const auto& relay : relays) ports.push_back(relay->port());
    return ports;
  }
  /// CPU times of the owner, of nats-server and of the followers, s.
  std::vector<double> used() const {
    std::vector<double> seconds{owner->cpu_seconds(), nats.cpu_seconds()};
    for (const auto& relay : relays) seconds.push_back(relay->cpu_seconds());
    return seconds;
  }
};

/// Cuts, and prints the CPU time that the servers have used meanwhile.
void cut(const Servers& servers, Raster& raster, double seconds, const char* when) {
  const auto before = servers.used();
  const auto start = Clock::now();
  auto trips = raster.cut(static_cast<std::uint64_t>(1000 * seconds));
  const double took = std::chrono::duration<double>(Clock::now() - start).count();
  const auto after = servers.used();
  std::printf(
      "%s: round trips p50 %.0f us, p99 %.0f us; cores used: owner %.3f, NATS %.3f, "
      "followers",
      when, at_share(trips, 0.5), at_share(trips, 0.99), (after[0] - before[0]) / took,
      (after[1] - before[1]) / took);
  for (std::size_t n = 2; n < after.size(); ++n) {
    std::printf(" %.3f", (after[n] - before[n]) / took);
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  std::setvbuf(stdout, nullptr, _IOLBF, 4096);
  allow_many_files();
  const Servers servers(options);
  post(servers.owner->port(), "/v1/sessions?id=bench&here=1", scene_for(2 * options.seconds));
  std::this_thread::sleep_for(std::chrono::seconds(3));  // until all know where it is
  AnswerTimes answers;
  Crowd first({servers.relay_ports(), options.relays}, answers);  // so that they follow
  first.wait_for_all(options.relays, 60);
  Raster raster(servers.owner->port(), "bench", options.agents, &answers);
  cut(servers, raster, options.seconds, "one viewer at each follower");
  Crowd crowd({servers.relay_ports(), options.viewers}, answers);
  crowd.wait_for_all(options.viewers, 120);
  cut(servers, raster, options.seconds, "with all viewers");
  const CrowdReport& report = crowd.report();
  std::printf(
      "%d viewers at %d followers: %d joined, %d dropped; each got %.1f mesh frames/s; "
      "staleness p50 %zu ms, p99 %zu ms\n",
      options.viewers, options.relays, report.joined.load(), report.dropped.load(),
      double(report.mesh_frames) / options.viewers / options.seconds, report.stale_at(0.5),
      report.stale_at(0.99));
  return report.joined == options.viewers && report.dropped == 0 ? 0 : 1;
}
