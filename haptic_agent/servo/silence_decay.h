// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace kerf::agent {

/// Up to this age a wrench is rendered in full.
inline constexpr std::uint64_t kFullWrenchUs = 20'000;
/// From this age on it is zero.
inline constexpr std::uint64_t kNoWrenchUs = 120'000;
/// Time constant of its decay between the two.
inline constexpr double kDecayUs = 40'000.0;

/// Returns the factor for a wrench of this age, 0 to 1, so that forces end when answers stop.
inline double wrench_share(std::uint64_t age_us) noexcept {
  if (age_us <= kFullWrenchUs) return 1.0;
  if (age_us >= kNoWrenchUs) return 0.0;
  return std::exp(-static_cast<double>(age_us - kFullWrenchUs) / kDecayUs);
}

/// Returns the age of an answer: the time since its arrival or, if greater, the time since the
/// answered pose was measured, less the round trip that counts as prompt. Forces therefore also
/// fade if the server answers steadily but with growing delay.
inline std::uint64_t answer_age_us(std::uint64_t now_us, std::uint64_t arrival_us,
                                   std::uint64_t pose_us) noexcept {
  const std::uint64_t silent_us = now_us > arrival_us ? now_us - arrival_us : 0;
  const std::uint64_t lag_us = now_us > pose_us ? now_us - pose_us : 0;
  return std::max(silent_us, lag_us > kFullWrenchUs ? lag_us - kFullWrenchUs : 0);
}

/// Greatest delay of an answer that counts as prompt for the local model, which stays accurate with
/// late answers: a round trip of 250 ms and its jitter.
inline constexpr std::uint64_t kModelLagUs = 350'000;

/// While the replica answers the newest poses, forces stay accurate without the server. Silence of
/// the server up to this time does not reduce them.
inline constexpr std::uint64_t kReplicaFullUs = 100'000;
/// From this time on the force is zero, within the 150 ms allowed after the loss of a server.
inline constexpr std::uint64_t kReplicaNoneUs = 140'000;

/// Like answer_age_us, while the replica answers.
inline std::uint64_t replica_age_us(std::uint64_t now_us, std::uint64_t arrival_us) noexcept {
  const std::uint64_t silent_us = now_us > arrival_us ? now_us - arrival_us : 0;
  if (silent_us <= kReplicaFullUs) return std::min(silent_us, kFullWrenchUs);
  return kFullWrenchUs + (silent_us - kReplicaFullUs) * (kNoWrenchUs - kFullWrenchUs) /
                             (kReplicaNoneUs - kReplicaFullUs);
}

/// Like answer_age_us, for the local model.
inline std::uint64_t model_age_us(std::uint64_t now_us, std::uint64_t arrival_us,
                                  std::uint64_t pose_us) noexcept {
  const std::uint64_t silent_us = now_us > arrival_us ? now_us - arrival_us : 0;
  const std::uint64_t lag_us = now_us > pose_us ? now_us - pose_us : 0;
  return std::max(silent_us, lag_us > kModelLagUs ? lag_us - kModelLagUs : 0);
}

}  // namespace kerf::agent
