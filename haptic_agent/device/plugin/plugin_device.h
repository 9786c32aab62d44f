// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <expected>
#include <memory>
#include <string>
#include <string_view>

#include "haptic_agent/device/carving_figure.h"
#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/library/kerf_agent.h"

namespace kerf::agent {

/// Why a plugin cannot be used.
enum class PluginFault : std::uint8_t {
  kNotLoaded,   ///< the file is missing, is no shared library, or needs a missing one
  kNoSymbol,    ///< it does not export kPluginSymbol
  kVersion,     ///< it has another ABI version
  kIncomplete,  ///< a required function is missing
  kOpen,        ///< its `open` failed
  kCapability,  ///< a capability is out of range
};

struct PluginError {
  PluginFault fault = PluginFault::kNotLoaded;
  /// One sentence.
  std::string text;
};

/// Name of the function that a plugin exports (kerf_agent_plugin_function).
inline constexpr const char* kPluginSymbol = "kerf_agent_plugin";

/// A loaded plugin. It stays loaded until the program ends: its threads may outlive a device.
struct Plugin {
  kerf_agent_device functions{};
  std::string file;
  /// Passed to the plugin's `open`.
  std::string argument;
};

/// Loads FILE.so[:ARGUMENT] and checks its table of functions.
std::expected<Plugin, PluginError> load_plugin(std::string_view text);

/// A device of a plugin. The servo thread calls the plugin's functions directly.
class PluginDevice final : public HapticDevice {
 public:
  /// Opens the device, which may wait for seconds.
  static std::expected<std::unique_ptr<PluginDevice>, PluginError> open(const Plugin& plugin,
                                                                        const StockBox& stock,
                                                                        double pivot_mm,
                                                                        std::uint32_t participant);
  ~PluginDevice() override;
  PluginDevice(const PluginDevice&) = delete;
  PluginDevice& operator=(const PluginDevice&) = delete;

  DeviceCapabilities capabilities() const override { return capabilities_; }
  DeviceState read(std::uint64_t now_us) noexcept override;
  void write(const Wrench& wrench) noexcept override;
  void stop() noexcept override;
  std::string trouble() const override;

 private:
  PluginDevice(const kerf_agent_device& functions, void* device) noexcept
      : functions_(functions), device_(device) {}

  kerf_agent_device functions_;
  void* device_;
  DeviceCapabilities capabilities_;
  /// State of the newest pose, for trouble().
  std::atomic<std::uint32_t> state_{KERF_AGENT_ABSENT};
};

}  // namespace kerf::agent
