// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/reference/reference_protocol.h"
#include "haptic_agent/realtime/realtime_thread.h"
#include "tests/support/test.h"
#include "tests/usb/model/reference_firmware.h"
#include "tests/usb/rig.h"

namespace kerf::usb_test::timing_test {
namespace {

namespace ref = agent::reference;

void print(const char* what, std::vector<std::uint64_t>& times_us) {
  if (times_us.empty()) return;
  std::ranges::sort(times_us);
  const auto at = [&](double part) {
    const auto index = static_cast<std::size_t>(part * static_cast<double>(times_us.size()));
    return static_cast<unsigned long>(times_us[std::min(index, times_us.size() - 1)]);
  };
  std::printf("[ timing   ] %s: p50 %lu, p99 %lu, max %lu us (%zu)\n", what, at(0.5), at(0.99),
              at(1.0), times_us.size());
}

// Times are printed but not asserted. The assertions hold on any machine.
TEST(UsbTiming, OneSecondAtOneKilohertzThroughLibusb) {
  Rig<ReferenceFirmware> rig;
  agent::UsbHapticDevice device(std::make_unique<ref::ReferenceProtocol>(ref::PenPlace{}),
                                rig.settings());
  ASSERT_TRUE(eventually([&] { return is_ready(device); }));
  const auto before = device.counters().reports.load();
  std::vector<std::uint64_t> ages_us, intervals_us;
  bool fifo = false;
  std::thread servo([&] {
    fifo = agent::request_fifo(agent::kServoPriority) == 0;
    auto next = std::chrono::steady_clock::now();
    std::uint64_t last_us = 0;
    for (int i = 0; i < 1000; ++i) {
      next += std::chrono::milliseconds(1);
      std::this_thread::sleep_until(next);
      const std::uint64_t now_us = agent::monotonic_us();
      const auto state = device.read(now_us);
      device.write({.force_n = {1, 0, 0}, .torque_nmm = {}});
      if (!state.valid) continue;
      ages_us.push_back(now_us - std::min(now_us, state.time_us));
      if (last_us != 0 && state.time_us != last_us) intervals_us.push_back(state.time_us - last_us);
      last_us = state.time_us;
    }
  });
  servo.join();
  print(fifo ? "age of the pose, SCHED_FIFO" : "age of the pose, SCHED_OTHER", ages_us);
  print("between two poses", intervals_us);
  const auto [lost, rejected] = rig.query([](ReferenceFirmware& firmware) {
    return std::pair{firmware.lost_commands(), firmware.rejected()};
  });
  std::printf("[ timing   ] %lu reports, %lu commands\n",
              static_cast<unsigned long>(device.counters().reports - before),
              static_cast<unsigned long>(device.counters().sent.load()));
  EXPECT_LE(lost, device.counters().timeouts.load());
  EXPECT_EQ(rejected, 0U);
  EXPECT_EQ(device.counters().bad_reports.load(), 0U);
  EXPECT_GT(device.counters().reports.load(), before);
}

}  // namespace
}  // namespace kerf::usb_test::timing_test
