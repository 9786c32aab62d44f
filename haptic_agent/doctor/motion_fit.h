// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <vector>

namespace kerf::agent {

/// Position and effort along one coordinate of a device at one tick: mm and N, or rad and N mm.
struct MotionRecord {
  double position = 0, effort = 0;
};

/// The mechanics along that coordinate. Position, effort and time are in mm, N and s, or rad, N mm
/// and s: a mass of 1 N s²/mm is 1000 kg, an inertia of 1 N mm s² is 1e-3 kg m².
struct MotionFit {
  double mass = 0;
  double viscous = 0;    ///< effort per velocity
  double friction = 0;   ///< Coulomb friction
  double stiffness = 0;  ///< of a spring that holds the device; about 0 if the device is free
  double latency_s = 0;  ///< from a written effort to its action
  double quantum = 0;    ///< quantum of the measured position; 0 if none was found
  /// Share of the effort that the fit leaves unexplained, rms over rms.
  double error = 0;
};

/// Fits mass, viscous and Coulomb friction, a spring and a constant effort to a motion at 1 kHz, at
/// the latency from 0 to 15 ms with the best fit. Both sides of the equation of motion pass the
/// same low-pass filter, which removes the steps of the encoder but not the motion. The error is
/// one sentence: the device hardly moved, or the fit explains less than half of the effort.
std::expected<MotionFit, std::string> fit_motion(const std::vector<MotionRecord>& motion);

/// Returns the quantum of measured positions: the greatest step of which all changes from tick to
/// tick are multiples, within a tenth, or 0 if there is none.
double quantum_of(const std::vector<MotionRecord>& motion);

}  // namespace kerf::agent
