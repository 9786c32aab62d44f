#pragma once

#include <atomic>
#include <cstdint>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/servo/latest_value.h"
#include "haptic_agent/servo/sample_ring.h"
#include "haptic_agent/servo/servo_loop.h"
#include "haptic_agent/servo/wrench_interpolator.h"
#include "haptic_agent/servo/wrench_limiter.h"

namespace kerf::agent {

/// Told after each sample that there is something to send; must not wait.
class SampleListener {
 public:
  virtual ~SampleListener() = default;
  virtual void sample_ready() noexcept = 0;
};

struct ServoSettings {
  WrenchLimits limits{};
  /// The tool of samples whose device asks for none.
  std::uint32_t tool_id = 1;
  /// Ends the loop after this time; 0: never.
  std::uint64_t duration_us = 0;
};

/// What the cycle has seen; read it when the loop has ended.
struct ServoReport {
  std::uint64_t samples = 0;
  /// The link was a whole ring behind, and the sample was dropped.
  std::uint64_t ring_overflows = 0;
  /// The device had no pose, or none that was finite.
  std::uint64_t invalid_poses = 0;
  /// Ticks in which an answer was too old to be shown in full.
  std::uint64_t decayed_ticks = 0;
  double max_force_n = 0;
  double max_torque_nmm = 0;
};

/// One tick: read the device, hand the pose to the link, and show the newest wrench: interpolated,
/// faded when the server falls silent, limited. No allocation, lock, exception or output.
/// The passivity layer of the README belongs between fading and limiting.
class ServoCycle final : public ServoTask {
 public:
  /// All references must outlive the cycle.
  ServoCycle(HapticDevice& device, SampleRing& samples, LatestValue<ServerWrench>& wrenches,
             SampleListener& listener, const ServoSettings& settings) noexcept;

  bool tick(std::uint64_t now_us) noexcept override;

  const ServoReport& report() const noexcept { return report_; }
  const WrenchLimiter& limiter() const noexcept { return limiter_; }

 private:
  bool send(const DeviceState& state) noexcept;
  Wrench wanted(std::uint64_t now_us) noexcept;

  HapticDevice& device_;
  SampleRing& samples_;
  LatestValue<ServerWrench>& wrenches_;
  SampleListener& listener_;
  ServoSettings settings_;
  WrenchInterpolator interpolator_;
  WrenchLimiter limiter_;
  ServoReport report_;
  std::uint64_t start_us_ = 0;
  std::uint64_t last_us_ = 0;
};

}  // namespace kerf::agent
