#include "kernel/sweep/swept_tool.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf {
namespace {

using Visitor = std::function<void(const SubMotion&)>;

/// Greatest turn of one sub-motion: the contact search starts from a translation.
constexpr double kTurnPerSubMotionMax = 0.15;

/// The part of a piece that can reach below the top of the block during the motion, or nothing.
/// Along a great circle within the upper half the axis leans most at one of its ends, and the tip
/// is lowest at one of its ends.
std::optional<ToolPiece> clip_to_block(const ToolPiece& piece, const ToolMotion& m, ZRange block) {
  const double uz = std::min(m.from.axis.z, m.to.axis.z);
  const double tip_z = std::min(m.from.tip_mm.z, m.to.tip_mm.z);
  if (!(uz > 0)) return piece;
  if (const auto* ball = std::get_if<BallPiece>(&piece)) {
    const double lowest = tip_z + uz * ball->center_mm - ball->radius_mm;
    return lowest > block.max_mm ? std::nullopt : std::optional(piece);
  }
  FrustumPiece f = std::get<FrustumPiece>(piece);
  const double lean = std::sqrt(std::max(0.0, 1 - uz * uz));
  const double reach = (block.max_mm - tip_z + std::max(f.r0_mm, f.r1_mm) * lean) / uz;
  const double needed = reach + 1e-3 * (f.z1_mm - f.z0_mm);  // Well clear of the block's top.
  if (reach <= f.z0_mm) return std::nullopt;
  if (needed < f.z1_mm) {
    f.r1_mm = f.r0_mm + (f.r1_mm - f.r0_mm) * ((needed - f.z0_mm) / (f.z1_mm - f.z0_mm));
    f.z1_mm = needed;
  }
  return f;
}

std::int64_t parts(double count) {
  if (!(count < double(kSubMotionsMax))) return kSubMotionsMax + 1;
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(count)));
}

/// Farthest that a point of the piece is from the tip.
double reach_of(const ToolPiece& piece) {
  if (const auto* ball = std::get_if<BallPiece>(&piece)) return ball->center_mm + ball->radius_mm;
  const auto& f = std::get<FrustumPiece>(piece);
  return std::sqrt(
      std::max(f.z0_mm * f.z0_mm + f.r0_mm * f.r0_mm, f.z1_mm * f.z1_mm + f.r1_mm * f.r1_mm));
}

std::int64_t tight_parts(const ToolPiece& piece, const ToolMotion& m, double tolerance_mm) {
  const double turn = m.turn_rad;
  if (turn == 0) return 1;
  if (const auto* ball = std::get_if<BallPiece>(&piece)) {
    return parts(turn * std::sqrt(ball->center_mm / (8 * tolerance_mm)));
  }
  const double error = turn * m.travel_mm / 4 + turn * turn * reach_of(piece) / 4;
  return parts(std::max(std::sqrt(error / tolerance_mm), turn / kTurnPerSubMotionMax));
}

std::int64_t paper_parts(const ToolPiece& piece, const ToolMotion& m, double tolerance_mm) {
  const double turn = m.turn_rad;
  if (turn == 0) return 1;
  return parts(std::max(turn * reach_of(piece) / tolerance_mm, turn / kTurnPerSubMotionMax));
}

std::int64_t parts_of(const ToolPiece& piece, const ToolMotion& m, MotionModel model,
                      double tolerance_mm) {
  return model == MotionModel::kTight ? tight_parts(piece, m, tolerance_mm)
                                      : paper_parts(piece, m, tolerance_mm);
}

SweptPiece sweep_piece(const ToolPiece& piece, const ToolPose& from, const ToolPose& to) {
  if (const auto* ball = std::get_if<BallPiece>(&piece)) {
    return BallSweep(from.tip_mm + from.axis * ball->center_mm,
                     to.tip_mm + to.axis * ball->center_mm, ball->radius_mm);
  }
  return FrustumSweep(std::get<FrustumPiece>(piece), from, to);
}

/// A piece whose axis has a point that the turn leaves at rest is cut in two there: on either side
/// of it the points move in opposite directions, and each half has a plain envelope.
void visit_sub_motion(const Visitor& visit, const ToolPiece& piece, const ToolMotion& part,
                      double share) {
  const auto* f = std::get_if<FrustumPiece>(&piece);
  const Vec3 du = part.to.axis - part.from.axis;
  const double du2 = dot(du, du);
  if (f != nullptr && du2 > 0) {
    const double still = -dot(part.to.tip_mm - part.from.tip_mm, du) / du2;
    const double margin = 1e-3 * (f->z1_mm - f->z0_mm);
    if (still > f->z0_mm + margin && still < f->z1_mm - margin) {
      const double r =
          f->r0_mm + (f->r1_mm - f->r0_mm) * (still - f->z0_mm) / (f->z1_mm - f->z0_mm);
      const FrustumPiece below{f->z0_mm, f->r0_mm, still, r}, above{still, r, f->z1_mm, f->r1_mm};
      visit({sweep_piece(below, part.from, part.to), part, share});
      visit({sweep_piece(above, part.from, part.to), part, share});
      return;
    }
  }
  visit({sweep_piece(piece, part.from, part.to), part, share});
}

}  // namespace

std::vector<std::int64_t> sub_motion_counts(const Tool& tool, const ToolMotion& motion,
                                            MotionModel model, double tolerance_mm, ZRange block) {
  std::vector<std::int64_t> counts;
  for (const ToolPiece& piece : tool.pieces) {
    const auto clipped = clip_to_block(piece, motion, block);
    counts.push_back(clipped ? parts_of(*clipped, motion, model, tolerance_mm) : 0);
  }
  return counts;
}

void sweep_tool(const Tool& tool, const ToolMotion& motion, MotionModel model, double tolerance_mm,
                ZRange block, const Visitor& visit) {
  const double reach = tool.length_mm;
  for (const ToolPiece& whole : tool.pieces) {
    const auto piece = clip_to_block(whole, motion, block);
    if (!piece) continue;
    const std::int64_t n = parts_of(*piece, motion, model, tolerance_mm);
    const double share = 1 / double(n);
    ToolPose from = motion.from;
    for (std::int64_t i = 1; i <= n; ++i) {
      const ToolPose to = motion.at(double(i) * share);
      if (model == MotionModel::kTight || motion.turn_rad == 0) {
        visit_sub_motion(visit, *piece, make_motion(from, to, reach), share);
      } else {
        // Eq. 12: the translation with the start's axis, then the rotation about the tip at the
        // end.
        const ToolPose arrived{to.tip_mm, from.axis};
        if (motion.travel_mm > 0) {
          visit_sub_motion(visit, *piece, make_motion(from, arrived, reach), share / 2);
        }
        visit_sub_motion(visit, *piece, make_motion(arrived, to, reach),
                         motion.travel_mm > 0 ? share / 2 : share);
      }
      from = to;
    }
  }
}

}  // namespace kerf
