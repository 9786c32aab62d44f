// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/device_choice.h"

#include <charconv>
#include <utility>

#include "haptic_agent/device/falcon/falcon_firmware.h"
#include "haptic_agent/device/falcon/falcon_protocol.h"
#include "haptic_agent/device/gamepad/gamepad.h"
#include "haptic_agent/device/reference/reference_protocol.h"
#include "haptic_agent/device/replay.h"
#include "haptic_agent/device/socket/socket_device.h"
#include "haptic_agent/device/spacemouse/space_mouse.h"
#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {
namespace {

/// Longer than arming takes at the longest network delay (servo/README.md, "Safety").
constexpr double kRestAtStartS = 0.5;
/// Encoders of the simulated hand, in the class of an Inverse3 or Omega.
constexpr double kSimulatedQuantumMm = 0.01, kSimulatedQuantumRad = 2e-4;

std::expected<DeviceChoice, std::string> with_file(DeviceKind kind, std::string_view path) {
  auto script = load_script(std::string(path));
  if (!script) return std::unexpected(to_string(script.error()));
  return DeviceChoice{.kind = kind, .script = std::move(*script)};
}

std::optional<std::uint16_t> to_id(std::string_view text) {
  constexpr int kHexadecimal = 16;
  std::uint16_t id = 0;
  const char* end = text.data() + text.size();
  const auto [stop, failed] = std::from_chars(text.data(), end, id, kHexadecimal);
  if (failed != std::errc{} || stop != end) return std::nullopt;
  return id;
}

std::expected<DeviceChoice, std::string> with_ids(std::string_view text) {
  const std::size_t colon = text.find(':');
  const auto vendor = to_id(text.substr(0, colon));
  const auto product =
      colon == std::string_view::npos ? std::nullopt : to_id(text.substr(colon + 1));
  if (!vendor || !product) {
    return std::unexpected(join({"'", text, "' is not a pair of USB ids such as 1209:0001"}));
  }
  return DeviceChoice{.kind = DeviceKind::kReference, .usb_id = {*vendor, *product}};
}

std::expected<DeviceChoice, std::string> with_firmware(std::string_view path) {
  auto firmware = falcon::read_firmware(std::string(path));
  if (!firmware) return std::unexpected(firmware.error());
  return DeviceChoice{.kind = DeviceKind::kFalcon, .firmware = std::move(*firmware)};
}

std::expected<DeviceChoice, std::string> with_plugin(std::string_view text) {
  auto plugin = load_plugin(text);
  if (!plugin) return std::unexpected(plugin.error().text);
  return DeviceChoice{.kind = DeviceKind::kPlugin, .plugin = *std::move(plugin)};
}

std::expected<DeviceChoice, std::string> with_socket(std::string_view text) {
  auto address = parse_socket_address(text);
  if (!address) return std::unexpected(address.error());
  return DeviceChoice{.kind = DeviceKind::kSocket, .socket = *std::move(address)};
}

std::expected<std::unique_ptr<HapticDevice>, std::string> open_plugin(const Plugin& plugin,
                                                                      const DevicePlace& place) {
  auto device = PluginDevice::open(plugin, place.stock, place.pivot_mm, place.participant);
  if (!device) return std::unexpected(device.error().text);
  return *std::move(device);
}

Vec3 middle_of_top(const StockBox& stock) noexcept {
  const Vec3 middle = (stock.min_mm + stock.max_mm) * 0.5;
  return {middle.x, middle.y, stock.max_mm.z};
}

}  // namespace

std::expected<DeviceChoice, std::string> choose_device(std::string_view text) {
  if (text == "sim") return DeviceChoice{};
  if (text == "usb") return DeviceChoice{.kind = DeviceKind::kReference};
  if (text == "falcon") return DeviceChoice{.kind = DeviceKind::kFalcon};
  if (text == "spacemouse") return DeviceChoice{.kind = DeviceKind::kSpaceMouse};
  if (text == "gamepad") return DeviceChoice{.kind = DeviceKind::kGamepad};
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  const std::string_view rest =
      colon == std::string_view::npos ? std::string_view{} : text.substr(colon + 1);
  if (kind == "sim" && !rest.empty()) return with_file(DeviceKind::kSimulated, rest);
  if (kind == "replay" && !rest.empty()) return with_file(DeviceKind::kReplay, rest);
  if (kind == "usb" && !rest.empty()) return with_ids(rest);
  if (kind == "falcon" && !rest.empty()) return with_firmware(rest);
  if (kind == "gamepad" && !rest.empty())
    return DeviceChoice{.kind = DeviceKind::kGamepad, .node = std::string(rest)};
  if (kind == "plugin") return with_plugin(rest);
  if (kind == "socket") return with_socket(rest);
  if (kind == "replay") return std::unexpected("replay needs a file: replay:FILE");
  return std::unexpected(
      join({"unknown device '", text,
            "'; use usb, falcon, spacemouse, gamepad, plugin:FILE.so, socket:PATH, sim, "
            "sim:FILE or replay:FILE"}));
}

std::expected<std::unique_ptr<HapticDevice>, std::string> make_device(
    const DeviceChoice& choice, const DevicePlace& place, const DeviceOptions& options) {
  const UsbPortSettings port{.notice = options.notice};
  const Vec3 middle_mm = middle_of_top(place.stock);
  switch (choice.kind) {
    case DeviceKind::kReference:
      return std::make_unique<UsbHapticDevice>(
          std::make_unique<reference::ReferenceProtocol>(
              reference::PenPlace{.middle_mm = middle_mm, .pivot_mm = place.pivot_mm},
              choice.usb_id),
          port);
    case DeviceKind::kFalcon:
      return std::make_unique<UsbHapticDevice>(
          std::make_unique<falcon::FalconProtocol>(
              falcon::FalconSettings{.middle_mm = middle_mm, .firmware = choice.firmware}),
          port);
    case DeviceKind::kSpaceMouse:
      return std::make_unique<SpaceMouse>(place.stock, port);
    case DeviceKind::kGamepad:
      return std::make_unique<Gamepad>(GamepadSettings{.node = choice.node,
                                                       .stock = place.stock,
                                                       .tools = place.tools,
                                                       .tool = place.tool,
                                                       .notice = options.notice});
    case DeviceKind::kPlugin:
      return open_plugin(*choice.plugin, place);
    case DeviceKind::kSocket:
      return SocketDevice::open({.address = choice.socket,
                                 .stock = place.stock,
                                 .pivot_mm = place.pivot_mm,
                                 .participant = place.participant,
                                 .notice = options.notice});
    case DeviceKind::kSimulated:
    case DeviceKind::kReplay:
      break;
  }
  PathCursor path(
      choice.script ? *choice.script : make_carving_figure(place.stock, place.participant),
      options.loop, options.speed);
  if (choice.kind == DeviceKind::kReplay) return std::make_unique<Replay>(std::move(path));
  return std::make_unique<SimulatedHand>(
      std::move(path), HandSettings{.stiffness_n_per_mm = options.stiffness_n_per_mm,
                                    .pivot_mm = place.pivot_mm,
                                    .quantum_mm = kSimulatedQuantumMm,
                                    .quantum_rad = kSimulatedQuantumRad,
                                    .rest_at_start_s = kRestAtStartS});
}

}  // namespace kerf::agent
