// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace kerf::agent {

/// Up to here a wrench counts in full.
inline constexpr std::uint64_t kFullWrenchUs = 20'000;
/// From here on there is none.
inline constexpr std::uint64_t kNoWrenchUs = 120'000;
/// Between the two it falls with this time constant.
inline constexpr double kDecayUs = 40'000.0;

/// What is left of a wrench of this age: a hand must not go on feeling what nobody computes any
/// more.
inline double wrench_share(std::uint64_t age_us) noexcept {
  if (age_us <= kFullWrenchUs) return 1.0;
  if (age_us >= kNoWrenchUs) return 0.0;
  return std::exp(-static_cast<double>(age_us - kFullWrenchUs) / kDecayUs);
}

/// The age of an answer: the time since it came, or, if that is more, the time since the pose that
/// it answers less the round trip that still counts as prompt. So a server that answers steadily
/// but ever later falls silent too.
inline std::uint64_t answer_age_us(std::uint64_t now_us, std::uint64_t arrival_us,
                                   std::uint64_t pose_us) noexcept {
  const std::uint64_t silent_us = now_us > arrival_us ? now_us - arrival_us : 0;
  const std::uint64_t lag_us = now_us > pose_us ? now_us - pose_us : 0;
  return std::max(silent_us, lag_us > kFullWrenchUs ? lag_us - kFullWrenchUs : 0);
}

/// A model goes on being right while its answers are late, so only these are too late for it: a
/// round trip of 250 ms and its jitter still count as prompt.
inline constexpr std::uint64_t kModelLagUs = 350'000;

/// A copy of the block that answers the newest poses is right without the server, so a silence of
/// the server up to here counts as no more than a prompt answer's age ...
inline constexpr std::uint64_t kNearSilenceUs = 100'000;
/// ... and from here on as one that gives no force: within the 150 ms that a lost server may take.
inline constexpr std::uint64_t kNearNoneUs = 140'000;

/// As answer_age_us, while a copy near by answers.
inline std::uint64_t near_age_us(std::uint64_t now_us, std::uint64_t arrival_us) noexcept {
  const std::uint64_t silent_us = now_us > arrival_us ? now_us - arrival_us : 0;
  if (silent_us <= kNearSilenceUs) return std::min(silent_us, kFullWrenchUs);
  return kFullWrenchUs + (silent_us - kNearSilenceUs) * (kNoWrenchUs - kFullWrenchUs) /
                             (kNearNoneUs - kNearSilenceUs);
}

/// As answer_age_us, for the local model.
inline std::uint64_t model_age_us(std::uint64_t now_us, std::uint64_t arrival_us,
                                  std::uint64_t pose_us) noexcept {
  const std::uint64_t silent_us = now_us > arrival_us ? now_us - arrival_us : 0;
  const std::uint64_t lag_us = now_us > pose_us ? now_us - pose_us : 0;
  return std::max(silent_us, lag_us > kModelLagUs ? lag_us - kModelLagUs : 0);
}

}  // namespace kerf::agent
