// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/doctor/checks.h"

#include <sys/mman.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/device/units.h"
#include "haptic_agent/force_notice.h"
#include "haptic_agent/realtime/clock.h"
#include "haptic_agent/z_width.h"

namespace kerf::agent {
namespace {

std::string limit_text(int resource) {
  rlimit limit{};
  getrlimit(static_cast<__rlimit_resource>(resource), &limit);
  return limit.rlim_cur == RLIM_INFINITY ? "unlimited" : std::to_string(limit.rlim_cur);
}

std::string hexadecimal(std::uint16_t id) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "%04x", id);
  return text.data();
}

std::string percent(double share) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%.2f %%", 100 * share);
  return text.data();
}

Finding judge_found(const FoundDevice& device) {
  const std::string at = join({"the ", device.name, " at ", device.node});
  if (device.word.empty()) {
    return {.health = Health::kWarning,
            .what = at + " uses a proprietary protocol, which requires its vendor's SDK",
            .advice = {"haptic_agent/device/README.md describes how to add a driver"}};
  }
  if (!device.fault) return {.what = join({at, " is accessible (--device ", device.word, ")"})};
  if (*device.fault != UsbFault::kPermission) {
    return {.health = Health::kBad, .what = usb_error(*device.fault, device.name).text};
  }
  return {.health = Health::kBad,
          .what = at + " is not accessible to this user",
          .advice = {"as root, add this line to /etc/udev/rules.d/70-kerf.rules (or copy "
                     "haptic_agent/70-kerf.rules, which contains it):",
                     udev_rule(device.id),
                     "then run udevadm control --reload && udevadm trigger and plug it in again"}};
}

/// Sends commands without force for a second, which a device can acknowledge.
void send_zero_force(HapticDevice& device) {
  constexpr int kCommands = 1000;
  for (int i = 0; i < kCommands; ++i) {
    device.read(monotonic_us());
    device.write({});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// A servo task without a device.
class Idle final : public ServoTask {
 public:
  explicit Idle(double seconds) : end_us_(static_cast<std::uint64_t>(seconds * kUsPerS)) {}
  bool tick(std::uint64_t now_us) noexcept override {
    if (start_us_ == 0) start_us_ = now_us;
    return now_us - start_us_ < end_us_;
  }

 private:
  std::uint64_t end_us_;
  std::uint64_t start_us_ = 0;
};

/// Keeps `threads` ordinary threads busy during its lifetime.
class Load {
 public:
  explicit Load(unsigned threads) {
    for (unsigned i = 0; i < threads; ++i) {
      threads_.emplace_back([](const std::stop_token& stop) {
        volatile double x = 1;
        while (!stop.stop_requested()) x = std::sqrt(x + 1);
      });
    }
  }

 private:
  std::vector<std::jthread> threads_;
};

}  // namespace

RealtimeReport probe_realtime() {
  RealtimeReport report;
  std::thread([&] { report = make_realtime({}); }).join();
  munlockall();
  return report;
}

Finding judge_priority(const RealtimeReport& report) {
  if (report.fifo) return {.what = "real-time priority: granted"};
  return {.health = Health::kWarning,
          .what = join({"real-time priority: denied (rtprio limit ", limit_text(RLIMIT_RTPRIO),
                        "); the 1 kHz loop runs as an ordinary thread and loses ticks under load"}),
          .advice = {"as root, add these lines to /etc/security/limits.d/kerf.conf and log in "
                     "again as a member of plugdev:",
                     "@plugdev - rtprio 90", "@plugdev - memlock unlimited",
                     "or grant the program the capability: setcap cap_sys_nice,cap_ipc_lock+ep "
                     "$(command -v kerf-agent)"}};
}

Finding judge_memory_lock(const RealtimeReport& report) {
  if (report.memory_locked) return {.what = "memory lock: granted"};
  return {.health = Health::kWarning,
          .what = join({"memory lock: denied (memlock limit ", limit_text(RLIMIT_MEMLOCK),
                        " bytes); a page fault may delay the loop"}),
          .advice = {"add @plugdev - memlock unlimited to /etc/security/limits.d/kerf.conf"}};
}

std::string udev_rule(UsbId id) {
  return join({R"(SUBSYSTEM=="usb", ENV{DEVTYPE}=="usb_device", ATTR{idVendor}==")",
               hexadecimal(id.vendor), R"(", ATTR{idProduct}==")", hexadecimal(id.product),
               R"(", MODE="0660", GROUP="plugdev", TAG+="uaccess")"});
}

std::vector<Finding> judge_usb(const std::expected<std::vector<FoundDevice>, std::string>& survey) {
  if (!survey) return {{.health = Health::kWarning, .what = survey.error()}};
  if (survey->empty()) {
    return {{.health = Health::kNote,
             .what = "no supported device on USB (the simulated hand, --device sim, needs none)"}};
  }
  std::vector<Finding> findings;
  for (const FoundDevice& device : *survey) findings.push_back(judge_found(device));
  return findings;
}

std::vector<Finding> check_device(const DeviceChoice& choice, double wait_s) {
  const auto made = make_device(choice, {}, {});
  if (!made) return {{.health = Health::kBad, .what = made.error()}};
  const std::unique_ptr<HapticDevice>& device = *made;
  const std::string name = device->capabilities().name;
  const std::uint64_t until_us = monotonic_us() + static_cast<std::uint64_t>(wait_s * kUsPerS);
  DevicePhase phase = DevicePhase::kClosed;
  while (monotonic_us() < until_us) {
    phase = device->read(monotonic_us()).phase;
    if (phase == DevicePhase::kReady) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  if (phase != DevicePhase::kReady) {
    const std::string trouble = device->trouble();
    return {{.health = Health::kBad,
             .what = trouble.empty() ? join({"the ", name, " did not become ready"}) : trouble}};
  }
  std::vector<Finding> findings{{.what = join({"the ", name, " is ready"})}};
  if (device->capabilities().max_force_n > 0 && choice.kind != DeviceKind::kSimulated) {
    send_zero_force(*device);
    findings.push_back(judge_latency(device->capabilities(), device->command_echo()));
    const std::optional<Finding> grip = judge_grip(device->capabilities());
    if (grip) findings.push_back(*grip);
    const DeviceCapabilities rated = device->capabilities();
    findings.push_back({.what = z_width_notice(rated, settings_for(rated, {}))});
  }
  return findings;
}

std::optional<Finding> judge_grip(const DeviceCapabilities& device) {
  const std::string notice = grip_notice(settings_for(device, {}));
  if (notice.empty()) return std::nullopt;
  return Finding{.health = Health::kNote, .what = notice};
}

Finding judge_latency(const DeviceCapabilities& device, const CommandEcho& echo) {
  constexpr const char* kUnmeasured =
      "; it does not acknowledge commands, so that it cannot be measured here";
  const auto ms = [](std::uint64_t us) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.1f ms", static_cast<double>(us) / 1000);
    return std::string(text.data());
  };
  const std::string declared = ms(device.latency_us);
  if (echo.count == 0) {
    return {.health = Health::kNote,
            .what = join({"the latency of the ", device.name, " is taken to be ", declared,
                          ", as its driver declares", kUnmeasured}),
            .advice = {"if the time from a pose to the motors' current is longer, declare it: "
                       "kerf-agent --latency MS"}};
  }
  Finding finding{
      .what = join({"the ", device.name, " acknowledges commands after ", ms(echo.mean_us),
                    " on average, ", ms(echo.most_us), " at most (of ", std::to_string(echo.count),
                    "); a latency of ", declared, " is declared"})};
  if (echo.most_us <= device.latency_us) return finding;
  constexpr std::uint64_t kUsPerMs = 1000;
  finding.health = Health::kWarning;
  finding.advice = {
      join({"the bound of the returned energy holds up to the declared latency: start "
            "kerf-agent with --latency ",
            std::to_string((echo.most_us + kUsPerMs - 1) / kUsPerMs),
            ", or find out what delays the USB bus"})};
  return finding;
}

LoopMeasurement measure_loop(double seconds, bool load) {
  LoopMeasurement measurement;
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  measurement.load_threads = load ? cores : 0;
  const Load busy(measurement.load_threads);
  MonotonicClock clock;
  ServoLoop loop(clock);
  Idle idle(seconds);
  std::thread([&] {
    measurement.realtime = make_realtime({});
    loop.run(idle);
  }).join();
  munlockall();
  measurement.stats = loop.stats();
  return measurement;
}

Finding judge_loop(const LoopMeasurement& measurement) {
  const CycleStats& s = measurement.stats;
  const auto us = [&](double part) { return std::to_string(s.wake_us.quantile_us(part)); };
  const std::uint64_t due = s.ticks + s.lost;
  const double lost = due == 0 ? 1.0 : static_cast<double>(s.lost) / static_cast<double>(due);
  Finding finding{
      .what = join({"1 kHz loop, ", measurement.realtime.fifo ? "SCHED_FIFO 80" : "SCHED_OTHER",
                    measurement.load_threads > 0 ? ", every core busy: " : ": ",
                    std::to_string(s.ticks), " of ", std::to_string(due), " ticks ran, ",
                    percent(lost), " lost; wake-up p50 ", us(0.5), ", p99 ", us(0.99), ", p99.9 ",
                    us(0.999), ", max ", std::to_string(s.wake_us.max_us()), " us; longest gap ",
                    std::to_string(s.longest_gap_us), " us"})};
  const bool fine = s.wake_us.quantile_us(0.99) <= kFineWakeUs && lost <= kFineLostShare;
  if (fine) return finding;
  finding.health = Health::kWarning;
  finding.advice.push_back(join({"target: p99 up to ", std::to_string(kFineWakeUs), " us and ",
                                 percent(kFineLostShare), " lost"}));
  finding.advice.push_back(
      measurement.realtime.fifo
          ? "close other programs; virtual machines and CPU power saving also delay threads; "
            "Debian's linux-image-rt-amd64 helps on real hardware"
          : "measured without real-time priority");
  return finding;
}

}  // namespace kerf::agent
