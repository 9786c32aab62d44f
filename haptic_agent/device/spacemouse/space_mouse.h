// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "haptic_agent/device/carving_figure.h"
#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/device/spacemouse/space_report.h"
#include "haptic_agent/device/usb/usb_port.h"
#include "haptic_agent/realtime/latest_value.h"

namespace kerf::agent {

/// Integrates the cap's deflection, which commands a velocity, to a pose.
class RateControl {
 public:
  static constexpr double kFullMmPerS = 60.0;
  static constexpr double kFullRadPerS = 1.0;
  /// Speed factor while the right button is pressed.
  static constexpr double kPrecise = 0.2;
  /// Largest tilt of the tool from the vertical.
  static constexpr double kMaxLeanRad = 1.4;

  /// Starts upright, 10 mm above the center of the stock's top. The tip stays within 50 mm of the
  /// stock's bounding box.
  explicit RateControl(const StockBox& stock) noexcept;

  void step(const CapDeflection& cap, double dt_s) noexcept;
  Vec3 tip_mm() const noexcept { return tip_mm_; }
  Vec3 axis() const noexcept { return axis_; }
  Vec3 least_mm() const noexcept { return least_mm_; }
  Vec3 most_mm() const noexcept { return most_mm_; }

 private:
  Vec3 least_mm_;
  Vec3 most_mm_;
  Vec3 tip_mm_;
  Vec3 axis_{0, 0, 1};
};

/// A 3Dconnexion SpaceMouse: input without force. The tool cuts while the left button is pressed.
class SpaceMouse final : public HapticDevice {
 public:
  /// A deflected cap reports every 8 or 16 ms. After a longer silence it is at rest or
  /// disconnected. The tool does not move.
  static constexpr std::uint64_t kSilenceUs = 50'000;

  SpaceMouse(const StockBox& stock, UsbPortSettings settings);

  DeviceCapabilities capabilities() const override;
  DeviceState read(std::uint64_t now_us) noexcept override;
  void write(const Wrench&) noexcept override {}
  void stop() noexcept override {}
  std::string trouble() const override { return port_.trouble(); }

  const UsbCounters& counters() const noexcept { return port_.counters(); }

 private:
  struct TimedCap {
    CapDeflection cap{};
    std::uint64_t time_us = 0;
  };

  /// Runs on the event thread.
  class Protocol final : public UsbProtocol {
   public:
    std::string_view name() const noexcept override { return "SpaceMouse"; }
    std::vector<UsbId> ids() const override { return space_mouse_ids(); }
    PipeRequirements required_pipes() const override;
    std::uint64_t silence_limit_us() const noexcept override { return 0; }
    std::expected<void, UsbError> identify(UsbSyncIo&) override { return {}; }
    void connected(std::uint64_t) noexcept override { cap_ = {}; }
    bool take(std::span<const std::uint8_t> packet, std::uint64_t now_us) noexcept override;
    std::size_t compose(std::span<std::uint8_t>, std::uint64_t) noexcept override { return 0; }
    void disable_motors() noexcept override {}
    void disconnected() noexcept override { caps.write({}); }
    DevicePhase phase() const noexcept override { return DevicePhase::kReady; }
    std::string_view trouble() const noexcept override { return {}; }

    LatestValue<TimedCap> caps;

   private:
    CapDeflection cap_;
    std::uint64_t moved_us_ = 0;
  };

  RateControl control_;
  TimedCap newest_;
  std::optional<std::uint64_t> last_us_;
  Protocol protocol_;
  UsbPort port_;
};

}  // namespace kerf::agent
