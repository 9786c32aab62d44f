// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "kernel/math/vec3.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// Compares the replica's answers with the server's later answers to the same samples. Cuts of
/// other participants within the last round trip cause temporary differences. A persistent
/// difference means that the replica has diverged.
class Agreement {
 public:
  /// Records an answer of the replica. Times must increase.
  void note(const wire::Result& local) {
    kept_[count_++ % kKept] = {local.agent_time_us, Vec3(local.force_n), !is_missing_};
    is_missing_ = false;
  }
  /// Records that the replica did not answer a sample.
  void note_missing() { is_missing_ = true; }

  /// Compares an answer of the server, which is the mean since its previous one, with the same mean
  /// of the replica's answers. Ignores it if the replica lacks an answer to a sample in that time.
  /// Pass all answers of the server, in their order.
  void compare(std::uint64_t agent_time_us, Vec3 force) {
    const std::optional<Vec3> local = mean(find(remote_us_), find(agent_time_us));
    remote_us_ = agent_time_us;
    if (!local) return;
    const Vec3 difference = *local - force;
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
  /// Returns the rms difference over the rms of the server's force, or 0 without any force.
  double error() const { return square_force_ > 0 ? std::sqrt(square_error_ / square_force_) : 0; }

 private:
  /// The last two seconds.
  static constexpr std::size_t kKept = 2048;
  static constexpr int kWindow = 1000;
  static constexpr std::size_t kBatchMax = wire::kMaxSamplesPerMotion;
  /// Smaller rms differences never count as divergence.
  static constexpr double kMinErrorN = 0.05;
  struct Answer {
    std::uint64_t time_us = 0;
    Vec3 force_n{};
    bool follows = false;  ///< the sample follows that of the previous answer
  };
  struct Window {
    int count = 0;
    double square_error = 0, square_force = 0;
  };

  static constexpr std::size_t kNone = SIZE_MAX;
  /// Returns the time-weighted mean of the replica's answers after index `before` up to `last`.
  std::optional<Vec3> mean(std::size_t before, std::size_t last) const {
    if (before == kNone || last == kNone || before >= last || last - before > kBatchMax) return {};
    Vec3 impulse;
    for (std::size_t n = before + 1; n <= last; ++n) {
      const Answer &answer = kept_[n % kKept], &earlier = kept_[(n - 1) % kKept];
      if (!answer.follows) return {};
      impulse = impulse + answer.force_n * static_cast<double>(answer.time_us - earlier.time_us);
    }
    const std::uint64_t time_us = kept_[last % kKept].time_us - kept_[before % kKept].time_us;
    return impulse * (1 / static_cast<double>(time_us));
  }
  /// Returns the number of the answer to the sample of that time.
  std::size_t find(std::uint64_t time_us) const {
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
    return found ? low : kNone;
  }

  std::array<Answer, kKept> kept_{};
  std::size_t count_ = 0;
  bool is_missing_ = true;
  std::uint64_t remote_us_ = 0;  ///< time of the server's last answer
  std::uint64_t compared_ = 0;
  double square_error_ = 0, square_force_ = 0;
  Window window_;
  bool diverged_ = false;
};

}  // namespace kerf::agent
