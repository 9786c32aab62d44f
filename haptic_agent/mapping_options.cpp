// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/mapping_options.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/plain_number.h"
#include "server/wire/limits.h"

namespace kerf::agent {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
constexpr double kMaxTurnDeg = 360;
constexpr int kDigits = 3;
/// Speed of the hand that users reach, mm/s. The notice warns about a lower limit of the server.
constexpr double kFastHandMmPerS = 300;
constexpr std::pair<std::string_view, ClutchButton> kClutches[] = {
    {"own", ClutchButton::kOwn},
    {"deadman", ClutchButton::kDeadman},
    {"undo", ClutchButton::kUndo},
    {"redo", ClutchButton::kRedo}};

/// Returns the rotation vector of a text: degrees about z, or three degrees X,Y,Z. Nullopt for
/// other texts and for more than a full turn.
std::optional<Vec3> read_turn(std::string_view text) {
  const auto fields = split_fields(text);
  if (fields.size() != 1 && fields.size() != 3) return std::nullopt;
  double degrees[3] = {};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto number = to_number(fields[i]);
    if (!number) return std::nullopt;
    degrees[fields.size() == 1 ? 2 : i] = *number;
  }
  const Vec3 turn_deg{degrees[0], degrees[1], degrees[2]};
  if (!(length(turn_deg) <= kMaxTurnDeg)) return std::nullopt;
  return turn_deg * kRadPerDeg;
}

double longest(Vec3 edges) noexcept { return std::max({edges.x, edges.y, edges.z}); }

SpaceBox workspace_of(const DeviceCapabilities& device) noexcept {
  return {device.workspace_min_mm, device.workspace_max_mm};
}

/// Whether the device can move the tool to every corner of the stock.
bool reaches(const WorkspaceMapping& mapping, const SpaceBox& workspace, const SpaceBox& stock) {
  const SpaceMap map(mapping);
  const Vec3 half = workspace.size() * 0.5;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Vec3 at{(corner & 1) != 0 ? stock.min_mm.x : stock.max_mm.x,
                  (corner & 2) != 0 ? stock.min_mm.y : stock.max_mm.y,
                  (corner & 4) != 0 ? stock.min_mm.z : stock.max_mm.z};
    const Vec3 off = map.to_device(at) - workspace.middle();
    if (std::abs(off.x) > half.x || std::abs(off.y) > half.y || std::abs(off.z) > half.z)
      return false;
  }
  return true;
}

/// Returns a remark about the fit. Empty if none is needed.
std::string fit_remark(const MappingOptions& options, const WorkspaceMapping& mapping,
                       const SpaceBox& workspace, const SpaceBox& stock) {
  if (!workspace.has_volume()) {
    return options.choice.fits ? "; the device does not state its workspace, so --scale auto uses "
                                 "1; --scale S sets another"
                               : "";
  }
  if (options.choice.fits || reaches(mapping, workspace, stock)) return "";
  return "; the device does not reach all of the stock: --scale auto fits it";
}

}  // namespace

std::expected<MappingOptions, std::string> read_mapping(const MappingTexts& texts) {
  MappingOptions options{.choice = {.fits = texts.scale == "auto", .gain = texts.gain}};
  if (!options.choice.fits) {
    const auto scale = to_number(texts.scale);
    if (!scale || !(*scale >= kScaleMin && *scale <= kScaleMax)) {
      return std::unexpected("--scale: must be auto or a number from 0.001 to 1000");
    }
    options.choice.scale = *scale;
  }
  const auto turn = read_turn(texts.turn_deg);
  if (!turn) {
    return std::unexpected(
        "--turn: must be degrees about z from -360 to 360, or three degrees X,Y,Z of a rotation "
        "vector whose length is at most 360");
  }
  options.choice.turn_rad = *turn;
  const auto* const clutch =
      std::ranges::find(kClutches, texts.clutch, [](const auto& known) { return known.first; });
  if (clutch == std::end(kClutches)) {
    return std::unexpected("--clutch: must be own, deadman, undo or redo");
  }
  options.clutch = clutch->second;
  return options;
}

std::expected<MappingSettings, std::string> mapping_of(const MappingOptions& options,
                                                       const DeviceCapabilities& device,
                                                       const StockBox& stock) {
  if (options.clutch == ClutchButton::kDeadman && !device.has_deadman) {
    return std::unexpected(join({"--clutch deadman: the ", device.name,
                                 " does not sense that it is held; use own, undo or redo"}));
  }
  return MappingSettings{
      placed_mapping(options.choice, {stock.min_mm, stock.max_mm}, workspace_of(device)),
      options.clutch};
}

std::string mapping_notice(const MappingOptions& options, const WorkspaceMapping& mapping,
                           const DeviceCapabilities& device, const StockBox& stock) {
  const SpaceBox workspace = workspace_of(device);
  const bool changes = options.choice.fits || !SpaceMap(mapping).is_identity();
  if (!workspace.has_volume() && !changes) return {};
  std::ostringstream out;
  out << "scale " << plain_number(mapping.scale, kDigits) << " (device ";
  if (workspace.has_volume()) {
    const double edge_mm = longest(workspace.size());
    out << plain_number(edge_mm, kDigits) << " mm → block "
        << plain_number(edge_mm * mapping.scale, kDigits) << " mm";
  } else {
    out << "1 mm → block " << plain_number(mapping.scale, kDigits) << " mm";
  }
  out << ")";
  if (mapping.turn_rad != Vec3{}) {
    out << ", turned by " << plain_number(length(mapping.turn_rad) / kRadPerDeg, kDigits)
        << " degrees";
  }
  out << ", force gain " << plain_number(mapping.gain, kDigits) << ", stiffness at the hand "
      << plain_number(mapping.stiffness_scale(), kDigits) << " x"
      << fit_remark(options, mapping, workspace, {stock.min_mm, stock.max_mm});
  const double fastest = wire::kMaxSpeedMmPerS / mapping.scale;
  if (fastest < kFastHandMmPerS) {
    out << "; the server takes no cuts faster than " << plain_number(fastest, kDigits)
        << " mm/s of the hand";
  }
  return out.str();
}

}  // namespace kerf::agent
