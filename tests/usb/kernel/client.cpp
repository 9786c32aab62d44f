// SPDX-License-Identifier: Apache-2.0
// Tests the driver with a real kernel's usbfs, in the guest that run.sh starts. The argument is the
// gadget's UDC attribute: writing to it plugs and unplugs. Prints one line per step; the last one
// is `kernel route: passed` or `failed`.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "haptic_agent/device/reference/reference_protocol.h"
#include "haptic_agent/device/usb/usb_haptic_device.h"
#include "haptic_agent/device/usb/usb_survey.h"

namespace kerf::agent {
namespace {

constexpr double kUsPerS = 1e6;
constexpr std::uint64_t kPatienceUs = 30'000'000;

class Trial {
 public:
  explicit Trial(std::string udc) : udc_(std::move(udc)) {}

  bool run() {
    for (const FoundDevice& found : survey_usb().value_or(std::vector<FoundDevice>{})) {
      std::printf("found the %s at %s\n", std::string(found.name).c_str(), found.node.c_str());
    }
    step("opened, identified and homed", [&] { return phase() == DevicePhase::kReady; });
    stream(5.0);
    plug("");
    step("unplugged: closed", [&] { return phase() == DevicePhase::kClosed; });
    plug("dummy_udc.0");
    step("plugged in again: homed", [&] { return phase() == DevicePhase::kReady; });
    stream(1.0);
    return passed_;
  }

 private:
  DevicePhase phase() { return device_->read(monotonic_us()).phase; }

  void plug(const std::string& name) {
    std::ofstream file(udc_);
    file << name << '\n';
  }

  void judge(const char* what, bool good, double value, const char* unit) {
    std::printf("%-7s %s: %.0f %s\n", good ? "ok" : "FAILED", what, value, unit);
    std::fflush(stdout);
    passed_ = passed_ && good;
  }

  void step(const char* what, const std::function<bool()>& done) {
    const std::uint64_t start_us = monotonic_us();
    bool good = false;
    while (!(good = done()) && monotonic_us() - start_us < kPatienceUs) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    judge(what, good, static_cast<double>(monotonic_us() - start_us) / 1000, "ms");
    if (!good) std::printf("        %s\n", device_->trouble().c_str());
  }

  /// Reads and writes like a servo; poses must be valid and commands must be sent.
  void stream(double seconds) {
    const UsbCounters& counters = device_->counters();
    const std::uint64_t reports = counters.reports, sent = counters.sent,
                        bad = counters.bad_reports;
    auto next = std::chrono::steady_clock::now();
    const std::uint64_t end_us = monotonic_us() + static_cast<std::uint64_t>(seconds * kUsPerS);
    while (monotonic_us() < end_us) {
      next += std::chrono::milliseconds(1);
      std::this_thread::sleep_until(next);
      device_->read(monotonic_us());
      device_->write({.force_n = {1, 0, 0}, .torque_nmm = {}});
    }
    const auto rate = [&](std::uint64_t now, std::uint64_t before) {
      return static_cast<double>(now - before) / seconds;
    };
    judge("reports in", rate(counters.reports, reports) > 10, rate(counters.reports, reports),
          "/s");
    judge("commands out", rate(counters.sent, sent) > 10, rate(counters.sent, sent), "/s");
    judge("rejected reports", counters.bad_reports == bad,
          static_cast<double>(counters.bad_reports - bad), "");
  }

  std::string udc_;
  bool passed_ = true;
  std::unique_ptr<UsbHapticDevice> device_ = std::make_unique<UsbHapticDevice>(
      std::make_unique<reference::ReferenceProtocol>(reference::PenPlace{}),
      UsbPortSettings{.notice = [](const std::string& line) { std::puts(line.c_str()); }});
};

}  // namespace
}  // namespace kerf::agent

int main(int argc, char** argv) {
  const bool passed = kerf::agent::Trial(argc > 1 ? argv[1] : "").run();
  std::puts(passed ? "kernel route: passed" : "kernel route: failed");
  return passed ? 0 : 1;
}
