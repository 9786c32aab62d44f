// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "kernel/force/milling_settings.h"
#include "kernel/tool/tool.h"
#include "tests/kernel/force/slot_fit.h"

namespace kerf::test {

/// Published means of recordings of a dynamometer in slots along +X, with a tool of two teeth at
/// one speed of the spindle: J. Li, ForceCalculation,
/// https://github.com/leekunhwee/ForceCalculation, commit 3fda341 (2019). Forces are those on the
/// tool: x along the feed, y to its left, z up.
struct PublishedSlots {
  std::string name;
  Tool tool;
  double corner_mm;  ///< radius of the edge's arc
  double rpm;
  double pitch_mm;  ///< of the block in which the slots are computed
  std::vector<SlotMean> means;
};

PublishedSlots published_bull_nose();
PublishedSlots published_ball();
PublishedSlots published_flat();

/// The coefficients of that repository's CommonCutterFull.m. They were not fitted to these
/// recordings. Three of the six are those of Al7075-T6 in the review that milling_presets.cpp
/// quotes. The workpiece is not named.
MillingSettings coefficients_of_another_source();
/// Kienzle's coefficients, with an exponent for each direction, that fit the means of the series
/// best: six numbers for fifteen components.
MillingSettings fitted_to_all(const PublishedSlots& slots);
/// The coefficients that fit all means but one best.
MillingSettings fitted_to_the_others(const PublishedSlots& slots, std::size_t left_out);

/// Errors of the law relative to the measured resultant: signed for the resultant's length, and for
/// the force as a vector.
struct SlotError {
  double length, vector;
};
SlotError slot_error(const PublishedSlots& slots, const SlotMean& mean, MillingSettings milling);

}  // namespace kerf::test
