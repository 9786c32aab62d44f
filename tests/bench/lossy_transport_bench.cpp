// SPDX-License-Identifier: Apache-2.0
// Measures the latency of results on a network that loses packets: the agent's link and a real
// server, with a path between them that delays IP packets and drops some, of TCP and UDP alike.
//
//   lossy_transport_bench [--server PATH] [--seconds S] [--delay-ms ONE_WAY]
//
// Prints, for each packet loss and each transport, the time from a pose to its result for each
// received result, and the age of the newest result, sampled every ms. Needs the right to create
// network namespaces.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "haptic_agent/link/server_link.h"
#include "haptic_agent/realtime/clock.h"
#include "tests/bench/lossy_path.h"

namespace {

using namespace kerf::agent;
using kerf::bench::LossyPath;
using Clock = std::chrono::steady_clock;

struct Options {
  std::string server = KERF_SERVER_PROGRAM;
  double seconds = 10, delay_ms = 25;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    if (name == "--server") {
      options.server = argv[i + 1];
    } else if (name == "--seconds") {
      options.seconds = std::atof(argv[i + 1]);
    } else if (name == "--delay-ms") {
      options.delay_ms = std::atof(argv[i + 1]);
    } else {
      std::fprintf(stderr, "unknown option %s\n", argv[i]);
      std::exit(1);
    }
  }
  return options;
}

std::uint64_t now_us() {
  MonotonicClock clock;
  return clock.now_ns() / 1000;
}

/// A spiral that cuts at 40 mm/s, with bends that prevent merging of samples, deeper in each run.
kerf::wire::MotionSample path(int n, int run, std::uint64_t time_us) {
  const double turn = 0.04 / 12 * n;
  const double radius = 12 + 0.2 * turn;
  return {.time_us = time_us,
          .tip_mm = {radius * std::cos(turn), radius * std::sin(turn),
                     -0.5 * (run + 1) - (n % 2 == 0 ? 0.02 : 0.0)},
          .tool_id = 1,
          .buttons = kerf::wire::kButtonCutting};
}

struct Run {
  LinkReport report;
  Histogram age_us;
};

Run carve(const Options& options, bool udp, int run, kerf::bench::PathFaults& faults, double loss) {
  SampleRing ring;
  LatestValue<ServerWrench> wrenches;
  ServerLink link(
      {.server = {LossyPath::kThere, "8080"},
       .session = "bench",
       .hello = {.name = "bench", .color = "", .tool_id = 1, .udp = udp},
       .notice = [](const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); },
       .failed = {}},
      ring, wrenches);
  faults.loss = 0;  // until UDP carries the samples
  link.start();
  if (const auto welcome = link.wait_welcome(); !welcome) {
    std::fprintf(stderr, "%s\n", welcome.error().c_str());
    std::exit(1);
  }
  Run result;
  ServerWrench newest;
  const int settle = 1000, count = settle + static_cast<int>(options.seconds * 1000);
  const auto start = Clock::now();
  const std::uint64_t start_us = now_us();
  for (int n = 1; n <= count; ++n) {
    std::this_thread::sleep_until(start + std::chrono::milliseconds(n));
    if (n == settle) faults.loss = loss;
    ring.push(path(n, run, start_us + 1000 * static_cast<std::uint64_t>(n)));
    link.sample_ready();
    wrenches.read(newest);
    if (n > settle) result.age_us.add(now_us() - newest.pose_us);
  }
  link.stop(10);
  faults.loss = 0;
  result.report = link.report();
  return result;
}

void print(double loss, bool udp, const Run& run) {
  const auto ms = [](const Histogram& h, double part) {
    return static_cast<double>(h.quantile_us(part)) / 1000;
  };
  const LinkReport& r = run.report;
  std::printf("%4.0f %%  %-9s %7.1f %7.1f %7.1f   %7.1f %7.1f %7.1f   %8llu %7llu %6llu\n",
              loss * 100, udp ? "UDP" : "WebSocket", ms(r.answer_us, 0.5), ms(r.answer_us, 0.99),
              ms(r.answer_us, 0.999), ms(run.age_us, 0.5), ms(run.age_us, 0.99),
              ms(run.age_us, 0.999), static_cast<unsigned long long>(r.results),
              static_cast<unsigned long long>(r.resent),
              static_cast<unsigned long long>(r.merged_cuts + r.thinned_cuts));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  std::string folder = (std::filesystem::temp_directory_path() / "kerf-bench-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) return 1;
  const std::string scene = folder + "/scene.json";
  std::ofstream(scene) << R"({"name":"bench",
    "stock":{"shape":"box","min_mm":[-50,-50,-50],"max_mm":[50,50,0]},
    "accuracy":{"rays":"dexel","pitch_mm":0.2,"tolerance_mm":0.01,"motion":"tight"},
    "tools":[{"id":1,"shape":"ball","diameter_mm":6,"length_mm":60}]})";
  {
    LossyPath path;
    path.faults().delay_us = static_cast<std::int64_t>(options.delay_ms * 1000);
    path.start(options.server + " --open --listen 10.83.0.2:8080 --data " + folder +
               "/data --scene " + scene + " 2>" + folder + "/log");
    std::printf("%.0f ms per direction, %.0f s at 1 kHz per row; ms from pose to result\n",
                options.delay_ms, options.seconds);
    std::printf("%6s  %-9s %23s   %23s\n", "", "", "results received", "age of newest result");
    std::printf("%6s  %-9s %7s %7s %7s   %7s %7s %7s   %8s %7s %6s\n", "loss", "transport", "p50",
                "p99", "p99.9", "p50", "p99", "p99.9", "results", "resent", "merged");
    int run = 0;
    for (const double loss : {0.0, 0.01, 0.05}) {
      for (const bool udp : {false, true}) {
        print(loss, udp, carve(options, udp, run++, path.faults(), loss));
      }
    }
  }
  std::filesystem::remove_all(folder);
  return 0;
}
