// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kernel/force/milling_settings.h"

namespace kerf {

/// Published coefficients of a material.
struct MillingPreset {
  const char* material;  ///< as scenes name it
  EdgeCoefficients cut_n_per_mm2, edge_n_per_mm;
  double chip_exponent;
  const char* source;  ///< where they were published
  const char* remark;  ///< which of them, and which are missing; a missing coefficient is 0
};

/// Returns all presets, in the order of their names.
std::span<const MillingPreset> milling_presets();

}  // namespace kerf
