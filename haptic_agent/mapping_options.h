// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>

#include "haptic_agent/device/carving_figure.h"
#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/servo/mapping/hand_mapping.h"

namespace kerf::agent {

/// Texts of the command line.
struct MappingTexts {
  std::string scale = "1";
  double gain = 1;
  std::string turn_deg = "0";
  std::string clutch = "own";
};

struct MappingOptions {
  MappingChoice choice{};
  ClutchButton clutch = ClutchButton::kOwn;
};

/// Reads `--scale` (a number from kScaleMin to kScaleMax, or auto), `--turn` (degrees about z, or a
/// rotation vector of three, at most 360 long) and `--clutch` (own, deadman, undo or redo). The
/// error is one sentence that begins with the option.
std::expected<MappingOptions, std::string> read_mapping(const MappingTexts& texts);

/// Returns the settings for a device. The error is one sentence: the device does not support the
/// clutch.
std::expected<MappingSettings, std::string> mapping_of(const MappingOptions& options,
                                                       const DeviceCapabilities& device,
                                                       const StockBox& stock);

/// Returns the line for the user: scale, size of the device's workspace in the block, force gain
/// and stiffness at the hand, and the remedy if the workspace is unknown or the stock does not fit.
/// Empty for a device with an unknown workspace without a mapping.
std::string mapping_notice(const MappingOptions& options, const WorkspaceMapping& mapping,
                           const DeviceCapabilities& device, const StockBox& stock);

}  // namespace kerf::agent
