// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/plugin/plugin_device.h"

#include <dlfcn.h>

#include <array>
#include <filesystem>
#include <utility>

#include "haptic_agent/device/plugin/c_structs.h"
#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {
namespace {

constexpr std::string_view kSuffix = ".so";

std::unexpected<PluginError> plugin_error(PluginFault fault, std::string_view file,
                                          std::string_view reason) {
  return std::unexpected(PluginError{fault, join({"the plugin ", file, " ", reason})});
}

/// Splits FILE.so[:ARGUMENT]; version numbers may follow the suffix.
std::pair<std::string, std::string> split_argument(std::string_view text) {
  const std::size_t suffix = text.find(kSuffix);
  const std::size_t colon = text.find(':', suffix == text.npos ? 0 : suffix);
  if (suffix == text.npos || colon == text.npos) return {std::string(text), {}};
  return {std::string(text.substr(0, colon)), std::string(text.substr(colon + 1))};
}

/// Returns the fault of a table of functions. Empty if the table is usable.
std::string_view missing_function(const kerf_agent_device& functions) noexcept {
  if (functions.capabilities == nullptr) return "has no function `capabilities`";
  if (functions.read_pose == nullptr) return "has no function `read_pose`";
  return {};
}

}  // namespace

std::expected<Plugin, PluginError> load_plugin(std::string_view text) {
  auto [file, argument] = split_argument(text);
  if (file.empty()) {
    return std::unexpected(
        PluginError{PluginFault::kNotLoaded, "plugin needs a file: plugin:FILE.so[:ARGUMENT]"});
  }
  // The loader searches its own folders for names without a slash.
  const std::string path = std::filesystem::absolute(file).string();
  void* const library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr) {
    const char* reason = ::dlerror();
    return plugin_error(PluginFault::kNotLoaded, file,
                        join({"cannot be loaded: ", reason != nullptr ? reason : "unknown"}));
  }
  auto* const entry =
      reinterpret_cast<kerf_agent_plugin_function*>(::dlsym(library, kPluginSymbol));
  if (entry == nullptr) {
    return plugin_error(PluginFault::kNoSymbol, file,
                        join({"does not export ", kPluginSymbol, " (kerf_agent.h)"}));
  }
  const kerf_agent_device* const table = entry();
  Plugin plugin{.file = file, .argument = std::move(argument)};
  if (table == nullptr || table->abi != KERF_AGENT_ABI || !read_struct(table, plugin.functions)) {
    const std::string abi = table != nullptr ? std::to_string(table->abi) : "none";
    return plugin_error(PluginFault::kVersion, file,
                        join({"was built for ABI ", abi, " of kerf_agent.h; this program has ABI ",
                              std::to_string(KERF_AGENT_ABI)}));
  }
  if (const auto missing = missing_function(plugin.functions); !missing.empty()) {
    return plugin_error(PluginFault::kIncomplete, file, missing);
  }
  return plugin;
}

std::expected<std::unique_ptr<PluginDevice>, PluginError> PluginDevice::open(
    const Plugin& plugin, const StockBox& stock, double pivot_mm, std::uint32_t participant) {
  const kerf_agent_place place{.struct_size = sizeof place,
                               .participant = participant,
                               .pivot_mm = pivot_mm,
                               .stock_min_mm = {stock.min_mm.x, stock.min_mm.y, stock.min_mm.z},
                               .stock_max_mm = {stock.max_mm.x, stock.max_mm.y, stock.max_mm.z},
                               .argument = plugin.argument.c_str()};
  void* opened = nullptr;
  std::array<char, 256> reason{};
  if (plugin.functions.open != nullptr &&
      plugin.functions.open(&place, &opened, reason.data(), reason.size()) != KERF_AGENT_OK) {
    reason.back() = '\0';
    return plugin_error(PluginFault::kOpen, plugin.file,
                        join({"cannot open its device: ", reason.data()}));
  }
  std::unique_ptr<PluginDevice> device(new PluginDevice(plugin.functions, opened));
  kerf_agent_capabilities given{};
  given.struct_size = sizeof given;
  given.name = plugin.functions.name;
  if (plugin.functions.capabilities(opened, &given) != KERF_AGENT_OK) {
    return plugin_error(PluginFault::kOpen, plugin.file, "does not state its capabilities");
  }
  given.struct_size = sizeof given;
  auto capabilities = capabilities_of(given);
  if (!capabilities) {
    return plugin_error(PluginFault::kCapability, plugin.file,
                        join({"states invalid capabilities: ", capabilities.error()}));
  }
  if (capabilities->max_force_n > 0 && plugin.functions.write_wrench == nullptr) {
    return plugin_error(PluginFault::kIncomplete, plugin.file, "has no function `write_wrench`");
  }
  device->capabilities_ = *std::move(capabilities);
  return device;
}

PluginDevice::~PluginDevice() {
  stop();
  if (functions_.close != nullptr) functions_.close(device_);
}

DeviceState PluginDevice::read(std::uint64_t now_us) noexcept {
  kerf_agent_pose pose{};
  pose.struct_size = sizeof pose;
  functions_.read_pose(device_, now_us, &pose);
  state_.store(pose.state, std::memory_order_relaxed);
  return state_of(pose, capabilities_.has_deadman, now_us);
}

void PluginDevice::write(const Wrench& wrench) noexcept {
  if (functions_.write_wrench == nullptr) return;
  const kerf_agent_wrench output = wrench_of(rated(wrench, capabilities_));
  functions_.write_wrench(device_, &output);
}

void PluginDevice::stop() noexcept {
  if (functions_.stop != nullptr) return functions_.stop(device_);
  write({});
}

std::string PluginDevice::trouble() const {
  switch (state_.load(std::memory_order_relaxed)) {
    case KERF_AGENT_READY:
    case KERF_AGENT_FINISHED:
      return {};
    case KERF_AGENT_HOMING:
      return join({"the ", capabilities_.name, " is homing"});
    case KERF_AGENT_FAULT:
      return join({"the ", capabilities_.name, " reports a fault"});
    default:
      return join({"the ", capabilities_.name, " is not connected"});
  }
}

}  // namespace kerf::agent
