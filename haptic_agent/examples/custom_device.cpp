// SPDX-License-Identifier: Apache-2.0
// custom_device: a custom device, run by the 1 kHz servo loop for a tenth of a second, against an
// elastic wall instead of a server. A real device reads its encoders in read() and sets its motors
// in write().
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/realtime/clock.h"
#include "haptic_agent/servo/servo_loop.h"

namespace {

using namespace kerf::agent;
using kerf::Wrench;

/// Moves up and down along a sine and crosses z = 0 in its lower half.
class SineDevice final : public HapticDevice {
 public:
  DeviceCapabilities capabilities() const override {
    return {.name = "sine", .sensed_dof = 5, .actuated_dof = 3, .max_force_n = 5};
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    if (start_us_ == 0) start_us_ = now_us;
    const double t_s = double(now_us - start_us_) * 1e-6;
    DeviceState state;
    state.tip_mm = {0, 0, 5 * std::cos(62.8 * t_s)};
    state.time_us = now_us;
    state.valid = true;
    state.phase = DevicePhase::kReady;
    return state;
  }
  void write(const Wrench& wrench) noexcept override {
    peak_n_ = std::max(peak_n_, wrench.force_n.z);
  }
  void stop() noexcept override {}
  double peak_n() const { return peak_n_; }

 private:
  std::uint64_t start_us_ = 0;
  double peak_n_ = 0;
};

/// Pushes the device out of the half-space z < 0 with 0.8 N/mm.
class WallTask final : public ServoTask {
 public:
  explicit WallTask(HapticDevice& device) : device_(device) {}
  bool tick(std::uint64_t now_us) noexcept override {
    const DeviceState state = device_.read(now_us);
    Wrench wrench;
    wrench.force_n.z = state.valid ? std::max(0.0, -0.8 * state.tip_mm.z) : 0.0;
    device_.write(wrench);
    return ++ticks_ < 100;
  }

 private:
  HapticDevice& device_;
  int ticks_ = 0;
};

}  // namespace

int main() {
  SineDevice device;
  WallTask task(device);
  MonotonicClock clock;
  ServoLoop loop(clock);
  loop.run(task);
  device.stop();
  std::printf("%s: %llu ticks, greatest force %.2f N\n", device.capabilities().name.c_str(),
              static_cast<unsigned long long>(loop.stats().ticks), device.peak_n());
  return device.peak_n() > 3 ? 0 : 1;
}
