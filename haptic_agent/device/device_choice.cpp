#include "haptic_agent/device/device_choice.h"

#include <utility>

#include "haptic_agent/device/replay.h"
#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {
namespace {

std::expected<DeviceChoice, std::string> with_file(DeviceKind kind, std::string_view path) {
  auto script = load_script(std::string(path));
  if (!script) return std::unexpected(to_string(script.error()));
  return DeviceChoice{.kind = kind, .script = std::move(*script)};
}

}  // namespace

std::expected<DeviceChoice, std::string> choose_device(std::string_view text) {
  if (text == "sim") return DeviceChoice{};
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  const std::string_view rest =
      colon == std::string_view::npos ? std::string_view{} : text.substr(colon + 1);
  if (kind == "sim" && !rest.empty()) return with_file(DeviceKind::kSimulated, rest);
  if (kind == "replay" && !rest.empty()) return with_file(DeviceKind::kReplay, rest);
  if (kind == "replay") return std::unexpected("replay needs a file: replay:FILE");
  if (kind == "usb" || kind == "falcon" || kind == "spacemouse") {
    return std::unexpected(
        join({"the device ", kind, " is not available yet; use sim, sim:FILE or ", "replay:FILE"}));
  }
  return std::unexpected(
      join({"there is no device '", text, "'; use sim, sim:FILE or replay:FILE"}));
}

std::unique_ptr<HapticDevice> make_device(const DeviceChoice& choice, const DevicePlace& place,
                                          const DeviceOptions& options) {
  PathCursor path(
      choice.script ? *choice.script : make_carving_figure(place.stock, place.participant),
      options.loop, options.speed);
  if (choice.kind == DeviceKind::kReplay) return std::make_unique<Replay>(std::move(path));
  return std::make_unique<SimulatedHand>(
      std::move(path),
      HandSettings{.stiffness_n_per_mm = options.stiffness_n_per_mm, .pivot_mm = place.pivot_mm});
}

}  // namespace kerf::agent
