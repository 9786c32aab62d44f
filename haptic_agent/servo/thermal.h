// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf::agent {

/// How warm motors are, by the mean square of what they gave over the last ten seconds or so (I²t).
class ThermalLoad {
 public:
  static constexpr double kTimeS = 10;

  /// `continuous` is what they stand for ever, in N or N·mm; 0: unknown, never too much.
  explicit ThermalLoad(double continuous) noexcept : square_most_(continuous * continuous) {}

  void take(double shown, double dt_s) noexcept {
    square_ += (shown * shown - square_) * (dt_s / kTimeS);
  }
  bool too_much() const noexcept { return square_most_ > 0 && square_ > square_most_; }

 private:
  double square_most_;
  double square_ = 0;
};

}  // namespace kerf::agent
