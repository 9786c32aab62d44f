// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/record/recorded_device.h"

#include "haptic_agent/record/recording.h"

namespace kerf::agent {

std::expected<DeviceChoice, std::string> choose_device_or_recording(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  if (!text.ends_with(".mcap") || (kind != "sim" && kind != "replay")) return choose_device(text);
  const std::string file(text.substr(colon + 1));
  const auto recording = read_recording(file);
  if (!recording) return std::unexpected(recording.error());
  auto path = path_of(*recording);
  if (!path) return std::unexpected(file + " " + path.error());
  return DeviceChoice{
      .kind = kind == "sim" ? DeviceKind::kSimulated : DeviceKind::kReplay,
      .script = *std::move(path),
  };
}

}  // namespace kerf::agent
