// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "kernel/math/vec3.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// Compares the replica's answers with the server's later answers to the same samples. Cuts of
/// other participants within the last round trip cause temporary differences; a replica that stays
/// different has diverged.
class Agreement {
 public:
  /// Records an answer of the replica. Times must increase.
  void note(const wire::Result& local) {
    kept_[count_++ % kKept] = {local.agent_time_us, Vec3(local.force_n)};
  }

  /// Compares an answer of the server; ignored if the replica had no answer to that sample.
  void compare(const wire::Result& remote) {
    const Answer* local = find(remote.agent_time_us);
    if (local == nullptr) return;
    const Vec3 force(remote.force_n), difference = local->force_n - force;
    ++compared_;
    square_error_ += dot(difference, difference);
    square_force_ += dot(force, force);
    ++window_.count;
    window_.square_error += dot(difference, difference);
    window_.square_force += dot(force, force);
    if (window_.count < kWindow) return;
    const double error_n = std::sqrt(window_.square_error / kWindow);
    diverged_ =
        diverged_ || (error_n > kMinErrorN && window_.square_error > window_.square_force / 4);
    window_ = {};
  }

  /// Returns true once after a window in which the rms difference exceeded half of the rms force.
  bool take_divergence() {
    const bool diverged = diverged_;
    diverged_ = false;
    return diverged;
  }

  std::uint64_t compared() const { return compared_; }
  /// Returns the rms of the difference over the rms of the server's force; 0 without any force.
  double error() const { return square_force_ > 0 ? std::sqrt(square_error_ / square_force_) : 0; }

 private:
  /// The last two seconds.
  static constexpr std::size_t kKept = 2048;
  static constexpr int kWindow = 1000;
  /// Smaller rms differences never count as divergence.
  static constexpr double kMinErrorN = 0.05;
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
  bool diverged_ = false;
};

}  // namespace kerf::agent
