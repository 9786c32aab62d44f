// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "kernel/math/vec3.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// How well what the copy answered agrees with what the server answered to the same samples later.
/// What others cut within a round trip makes them differ for that long; a copy that stays wrong is
/// in doubt.
class Agreement {
 public:
  /// The copy's answer. Times must grow.
  void note(const wire::Result& mine) {
    kept_[count_++ % kKept] = {mine.agent_time_us, Vec3(mine.force_n)};
  }

  /// The server's; ignored if the copy had no answer to that sample.
  void compare(const wire::Result& theirs) {
    const Answer* mine = find(theirs.agent_time_us);
    if (mine == nullptr) return;
    const Vec3 force(theirs.force_n), difference = mine->force_n - force;
    ++compared_;
    square_error_ += dot(difference, difference);
    square_force_ += dot(force, force);
    ++window_.count;
    window_.square_error += dot(difference, difference);
    window_.square_force += dot(force, force);
    if (window_.count < kWindow) return;
    const double error_n = std::sqrt(window_.square_error / kWindow);
    doubt_ = doubt_ || (error_n > kDoubtN && window_.square_error > window_.square_force / 4);
    window_ = {};
  }

  /// True once after a window in which the rms difference was above half of the force.
  bool take_doubt() {
    const bool doubt = doubt_;
    doubt_ = false;
    return doubt;
  }

  std::uint64_t compared() const { return compared_; }
  /// rms of the difference over rms of the server's force; 0 without any.
  double error() const { return square_force_ > 0 ? std::sqrt(square_error_ / square_force_) : 0; }

 private:
  /// The last two seconds.
  static constexpr std::size_t kKept = 2048;
  static constexpr int kWindow = 1000;
  /// Differences below this are no reason to begin afresh.
  static constexpr double kDoubtN = 0.05;
  struct Answer {
    std::uint64_t time_us = 0;
    Vec3 force_n{};
  };
  struct Window {
    int count = 0;
    double square_error = 0, square_force = 0;
  };

  const Answer* find(std::uint64_t time_us) const {
    std::size_t low = count_ > kKept ? count_ - kKept : 0, high = count_;
    while (low < high) {
      const std::size_t middle = low + (high - low) / 2;
      if (kept_[middle % kKept].time_us < time_us) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    const bool found = low < count_ && kept_[low % kKept].time_us == time_us;
    return found ? &kept_[low % kKept] : nullptr;
  }

  std::array<Answer, kKept> kept_{};
  std::size_t count_ = 0;
  std::uint64_t compared_ = 0;
  double square_error_ = 0, square_force_ = 0;
  Window window_;
  bool doubt_ = false;
};

}  // namespace kerf::agent
