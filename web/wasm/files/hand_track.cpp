// SPDX-License-Identifier: Apache-2.0
#include "web/wasm/files/hand_track.h"

#include <limits>
#include <variant>

namespace kerf::page {
namespace {

/// The server's limit guards others, and its time; here the page paces its own path.
constexpr double kAnySpeed = std::numeric_limits<double>::infinity();

}  // namespace

std::expected<std::optional<BatchRecord>, std::string> HandTrack::take(
    const wire::MotionSample& sample, const Sculpture& block) {
  if (!cuts(sample) || !track_.pose()) in_stroke_ = false;
  const auto step = track_.take(sample, block, kAnySpeed);
  if (!step) return std::unexpected(step.error().reason);
  const auto* move = std::get_if<MoveTool>(&*step);
  if (move == nullptr) return std::nullopt;
  if (const auto ok = block.check(*move); !ok) return std::unexpected(ok.error().reason);
  const bool begins_stroke = !in_stroke_;
  in_stroke_ = true;
  return BatchRecord{participant_, *move, begins_stroke};
}

}  // namespace kerf::page
