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
#include "haptic_agent/device/usb/monotonic.h"

namespace kerf::agent {
namespace {

constexpr double kUsPerS = 1e6;

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
            .what = at + " speaks a closed protocol, which needs its vendor's SDK",
            .advice = {"haptic_agent/device/README.md says how to plug one in"}};
  }
  if (!device.fault) return {.what = join({at, " may be opened (--device ", device.word, ")"})};
  if (*device.fault != UsbFault::kPermission) {
    return {.health = Health::kBad, .what = usb_error(*device.fault, device.name).text};
  }
  return {.health = Health::kBad,
          .what = at + " may not be opened by this user",
          .advice = {"as root, put this line into /etc/udev/rules.d/70-kerf.rules (or copy "
                     "haptic_agent/70-kerf.rules, which holds it, there):",
                     udev_rule(device.id),
                     "udevadm control --reload && udevadm trigger, then plug it in again"}};
}

/// Ticks as the servo does, without a device.
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

/// One ordinary thread a core that never rests, while it lives.
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
          .what = join({"real-time priority: rejected (rtprio limit ", limit_text(RLIMIT_RTPRIO),
                        "); the 1 kHz loop runs as an ordinary thread and loses ticks under load"}),
          .advice = {"as root, put these lines into /etc/security/limits.d/kerf.conf and log in "
                     "again as a member of plugdev:",
                     "@plugdev - rtprio 90", "@plugdev - memlock unlimited",
                     "or give the program the right: setcap cap_sys_nice,cap_ipc_lock+ep "
                     "$(command -v kerf-agent)"}};
}

Finding judge_memory_lock(const RealtimeReport& report) {
  if (report.memory_locked) return {.what = "memory lock: granted"};
  return {.health = Health::kWarning,
          .what = join({"memory lock: rejected (memlock limit ", limit_text(RLIMIT_MEMLOCK),
                        " bytes); a page fault may hold the loop up"}),
          .advice = {"@plugdev - memlock unlimited   in /etc/security/limits.d/kerf.conf"}};
}

std::string udev_rule(UsbId id) {
  return join({R"(SUBSYSTEM=="usb", ENV{DEVTYPE}=="usb_device", ATTR{idVendor}==")",
               hexadecimal(id.vendor), R"(", ATTR{idProduct}==")", hexadecimal(id.product),
               R"(", MODE="0660", GROUP="plugdev", TAG+="uaccess")"});
}

std::vector<Finding> judge_usb(const std::expected<std::vector<FoundDevice>, std::string>& survey) {
  if (!survey) return {{.health = Health::kWarning, .what = survey.error()}};
  if (survey->empty()) {
    return {{.health = Health::kWarning,
             .what = "no known device is on USB (the simulated hand, --device sim, needs none)"}};
  }
  std::vector<Finding> findings;
  for (const FoundDevice& device : *survey) findings.push_back(judge_found(device));
  return findings;
}

Finding check_device(const DeviceChoice& choice, double wait_s) {
  const auto device = make_device(choice, {}, {});
  const std::string name = device->capabilities().name;
  const std::uint64_t until_us = monotonic_us() + static_cast<std::uint64_t>(wait_s * kUsPerS);
  DevicePhase phase = DevicePhase::kClosed;
  while (monotonic_us() < until_us) {
    phase = device->read(monotonic_us()).phase;
    if (phase == DevicePhase::kReady) return {.what = join({"the ", name, " is ready"})};
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const std::string trouble = device->trouble();
  return {.health = Health::kBad,
          .what = trouble.empty() ? join({"the ", name, " has not become ready"}) : trouble};
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
  finding.advice.push_back(join({"fine is p99 up to ", std::to_string(kFineWakeUs), " us and ",
                                 percent(kFineLostShare), " lost"}));
  finding.advice.push_back(
      measurement.realtime.fifo
          ? "close other programs; a virtual machine or a power-saving CPU also holds threads up; "
            "Debian's linux-image-rt-amd64 helps on real hardware"
          : "without real-time priority this is what an ordinary thread gets");
  return finding;
}

}  // namespace kerf::agent
