// From what goes wrong to no force, in real time: the real servo, watchdog and link, a real server
// as a child, and a device that leans on a wall.
//
//   agent_trip_bench [--server PATH]
//
// For each event in each state in which there is force, prints the ms until the device shows none,
// and its limit: 150 ms for the server, 20 ms for the hand, the device and the loop. A frozen
// server stands for a frozen network thread as well: to the servo both are silence. Without
// real-time rights the machine's own delays are in the figures. Fails if one is over its limit.
#include <pthread.h>
#include <signal.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string>
#include <thread>

#include "haptic_agent/link/server_link.h"
#include "haptic_agent/servo/realtime.h"
#include "haptic_agent/servo/watchdog.h"
#include "tests/bench/live_client.h"

namespace {

using namespace kerf::agent;
using kerf::bench::Clock;

/// Rests above an obstacle until told to sink half a millimetre into it, slowly.
class Leaning final : public HapticDevice {
 public:
  DeviceCapabilities capabilities() const override {
    return {.name = "leaning", .max_force_n = 20, .max_torque_nmm = 500, .has_deadman = true};
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    while (frozen.load()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (lean.load() && depth_mm_ < 2) depth_mm_ += 0.004;
    return {.tip_mm = {0, 0, 10.5 - depth_mm_},
            .buttons = deadman.load() ? kerf::wire::kButtonDeadman : 0U,
            .time_us = now_us,
            .valid = plugged.load(),
            .phase = plugged.load() ? DevicePhase::kReady : DevicePhase::kClosed};
  }
  void write(const Wrench& wrench) noexcept override { show(length(wrench.force_n)); }
  void stop() noexcept override { show(0); }

  std::atomic<bool> lean{false}, deadman{true}, plugged{true}, frozen{false};
  std::atomic<double> force_n{0};
  /// When the force became nothing, ns of the steady clock; 0 while there is some.
  std::atomic<std::int64_t> silent_ns{0};

 private:
  void show(double newtons) noexcept {
    force_n.store(newtons);
    if (newtons > 0) {
      silent_ns.store(0);
    } else if (silent_ns.load() == 0) {
      silent_ns.store(Clock::now().time_since_epoch().count());
    }
  }
  double depth_mm_ = 0;
};

constexpr const char* kScene = R"({"name":"trip",
  "stock":{"shape":"box","min_mm":[-20,-20,-20],"max_mm":[20,20,0]},
  "accuracy":{"rays":"dexel","pitch_mm":0.5,"tolerance_mm":0.01,"motion":"tight"},
  "tools":[{"id":1,"shape":"ball","diameter_mm":10,"length_mm":60}],
  "obstacles":[{"shape":"box","min_mm":[-20,-20,5],"max_mm":[20,20,10],"stiffness_n_per_mm":1}]})";

struct Event {
  const char* name;
  double limit_ms;
  void (*happen)(Leaning&, kerf::bench::ServerProcess&);
};
const Event kEvents[] = {
    {"server killed", 150, [](Leaning&, kerf::bench::ServerProcess& s) { s.signal(SIGKILL); }},
    {"server frozen", 150, [](Leaning&, kerf::bench::ServerProcess& s) { s.signal(SIGSTOP); }},
    {"deadman released", 20, [](Leaning& d, kerf::bench::ServerProcess&) { d.deadman = false; }},
    {"device unplugged", 20, [](Leaning& d, kerf::bench::ServerProcess&) { d.plugged = false; }},
    {"loop stalled", 20, [](Leaning& d, kerf::bench::ServerProcess&) { d.frozen = true; }}};

/// Longest that an event is watched.
constexpr int kWaitMs = 2000;

constexpr ServoPhase kStates[] = {ServoPhase::kRamp, ServoPhase::kActive, ServoPhase::kDegraded};

void pause_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

/// Waits for a state; false if it does not come within five seconds.
bool wait_for(ServoCycle& cycle, ServoPhase phase) {
  for (int i = 0; i < 5000; ++i, pause_ms(1)) {
    ServoStatus status;
    if (cycle.status().read(status) && status.phase == phase) return true;
  }
  return false;
}

/// Leads the agent into a state with force in it.
bool reach(ServoPhase state, ServoCycle& cycle, Leaning& device,
           const kerf::bench::ServerProcess& server) {
  if (!wait_for(cycle, ServoPhase::kRamp)) return false;
  device.lean = true;
  if (state == ServoPhase::kRamp) {
    pause_ms(300);
    return true;
  }
  if (!wait_for(cycle, ServoPhase::kActive)) return false;
  pause_ms(300);
  if (state != ServoPhase::kDegraded) return true;
  server.signal(SIGSTOP);
  const bool reached = wait_for(cycle, ServoPhase::kDegraded);
  server.signal(SIGCONT);
  pause_ms(20);
  return reached;
}

/// ms to no force, at most kWaitMs; nothing if the state was not reached with a force on.
std::optional<double> time_to_silence(const std::string& program, const Event& event,
                                      ServoPhase state) {
  kerf::bench::ServerProcess server(program);
  kerf::bench::post(server.port(), "/v1/sessions?id=trip", kScene);
  Leaning device;
  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  LinkSettings settings;
  settings.server = {"127.0.0.1", std::to_string(server.port())};
  settings.session = "trip";
  settings.patience_s = 1;
  ServerLink link(settings, samples, wrenches);
  link.start();
  if (!link.wait_welcome()) return std::nullopt;
  MonotonicClock clock;
  ServoLoop loop(clock);
  ServoCycle cycle(device, samples, wrenches, link, settings_for(device.capabilities(), {}));
  Watchdog watchdog(loop, [&] { device.stop(); });
  watchdog.start();
  std::thread servo([&] {
    make_realtime({});
    loop.run(cycle);
  });
  std::optional<double> ms;
  if (reach(state, cycle, device, server) && device.force_n > 0) {
    const auto start = Clock::now();
    event.happen(device, server);
    const auto end = start + std::chrono::milliseconds(kWaitMs);
    while (device.silent_ns == 0 && Clock::now() < end) pause_ms(1);
    const auto silent = Clock::time_point(Clock::duration(device.silent_ns.load()));
    const auto until = device.silent_ns == 0 ? end : silent;
    ms = std::chrono::duration<double, std::milli>(until - start).count();
  }
  device.frozen = false;
  loop.stop();
  servo.join();
  watchdog.end();
  server.signal(SIGCONT);
  link.interrupt();
  link.stop(0);
  return ms;
}

/// The same, tried again where a busy machine was too slow to catch the hand in that state.
std::optional<double> try_to_silence(const std::string& program, const Event& event,
                                     ServoPhase state) {
  constexpr int kTries = 5;
  for (int i = 0; i < kTries; ++i) {
    if (const auto ms = time_to_silence(program, event, state)) return ms;
  }
  return std::nullopt;
}

}  // namespace

int main(int argc, char** argv) {
  std::string program = KERF_SERVER_PROGRAM;
  if (argc == 3 && std::strcmp(argv[1], "--server") == 0) program = argv[2];
  std::printf("%-18s %8s %8s %9s %8s   ms to no force\n", "", "ramp", "active", "degraded",
              "limit");
  bool kept = true, tried = true;
  for (const Event& event : kEvents) {
    std::printf("%-18s", event.name);
    for (const ServoPhase state : kStates) {
      const std::optional<double> ms = try_to_silence(program, event, state);
      kept = kept && (!ms || *ms <= event.limit_ms);
      tried = tried && ms;
      std::printf(" %8s", ms ? std::to_string(*ms).substr(0, 6).c_str() : "-");
      std::fflush(stdout);
    }
    std::printf(" %9.0f\n", event.limit_ms);
  }
  std::printf("ready, armed and safe show no force at all\n%s\n",
              !kept    ? "OVER A LIMIT"
              : !tried ? "within the limits, as far as it could be tried"
                       : "all within their limits");
  return kept && tried ? 0 : 1;
}
