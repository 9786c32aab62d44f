// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf::agent {

/// Thermal load of motors: the mean square of their output, low-pass filtered over 10 s (I²t).
class ThermalLoad {
 public:
  static constexpr double kTimeS = 10;

  /// `continuous`: continuous rating, N or N·mm, or 0 if unknown: never exceeded.
  explicit ThermalLoad(double continuous) noexcept : max_square_(continuous * continuous) {}

  void take(double output, double dt_s) noexcept {
    square_ += (output * output - square_) * (dt_s / kTimeS);
  }
  bool too_much() const noexcept { return max_square_ > 0 && square_ > max_square_; }

 private:
  double max_square_;
  double square_ = 0;
};

}  // namespace kerf::agent
