// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/swept_tool.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "kernel/math/tolerance.h"
#include "kernel/sweep/clip_to_block.h"

namespace kerf {
namespace {

/// Shares of the tolerance for the stations of a turning piece, and for the search between them.
constexpr double kStationShare = 0.9, kSearchShare = 0.1;

std::int64_t parts(double count) {
  if (!(count < double(kSubMotionsMax))) return kSubMotionsMax + 1;
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(count)));
}

/// A piece of the tool during a motion that turns little, and how it is swept.
struct PiecePlan {
  ToolPiece piece;    ///< the part that can reach into the block
  ToolPiece whole;    ///< all of it
  std::size_t which;  ///< index of the piece in the tool
  std::int64_t parts;
  double top_mm;            ///< of the block
  double bend_mm = 0;       ///< κ of a slice
  double disc_bend_mm = 0;  ///< κ of its discs, hidden or not
  bool round = false;       ///< the curvature of the slice exceeds the bend
  ShownDiscs shown = {true, true};
  bool shows_edge = true;  ///< an exposed disc makes an edge with the side
};

/// Returns the greatest distance of a point of the piece from the tip.
double reach_of(const ToolPiece& piece) {
  const Extent e = extent(piece);
  if (std::holds_alternative<BallPiece>(piece)) return e.z1_mm;
  return std::sqrt(std::max(e.z0_mm * e.z0_mm, e.z1_mm * e.z1_mm) + e.radius_mm * e.radius_mm);
}

/// Returns the greatest axial component of the unit normal of the piece's side.
double axial_normal(const ToolPiece& piece) {
  const auto* f = std::get_if<FrustumPiece>(&piece);
  if (f == nullptr) return 1;
  const double k = slope(*f);
  return std::abs(k) / std::sqrt(1 + k * k);
}

/// Returns whether a disc of a slice at height z is hidden within a neighboring piece, or is only
/// the tip of the slice.
bool covers(const ToolPiece* neighbor, double z_mm, double radius_mm) {
  if (radius_mm <= kTipMm) return true;
  return neighbor != nullptr &&
         radius_at(*neighbor, z_mm) >= radius_mm * (1 - kHiddenDiscShare) - kEdgeEpsilonMm;
}

/// Greatest speeds along and across the axis during a motion, in the frame of its middle (mm per
/// motion).
struct AxisSpeeds {
  double along, across;

  explicit AxisSpeeds(const ToolMotion& m) {
    const Vec3 u = normalized(m.from.axis + m.to.axis);
    const Vec3 v = m.to.tip_mm - m.from.tip_mm;
    const double along0 = std::abs(dot(v, u));
    const Vec3 across0 = v - u * dot(v, u);
    // The frame itself turns by half the turn to either side.
    const double half_turn = m.turn_rad / 2;
    along = along0 + length(across0) * half_turn;
    across = length(across0) + along0 * half_turn;
  }
};

/// Returns the least speed across the axis of its points from height z0 to z1 (mm per motion).
double least_across(const ToolMotion& m, double z0_mm, double z1_mm) {
  const Vec3 u = normalized(m.from.axis + m.to.axis);
  const Vec3 v = m.to.tip_mm - m.from.tip_mm, du = m.to.axis - m.from.axis;
  const Vec3 across = v - u * dot(v, u);
  const double du2 = dot(du, du);
  const double still = du2 > 0 ? -dot(across, du) / du2 : 0;
  const double least = length(across + du * std::clamp(still, z0_mm, z1_mm));
  return std::max(0.0, least - std::abs(dot(v, u)) * m.turn_rad / 2);
}

/// Returns whether the curvature of a cone exceeds the bend κ of the paths, so that each ray has a
/// single outermost end on it (kernel/sweep/bounds.md, "Stations"). A point that the slice holds at
/// any pose is considered at all poses, as long as it is inside the side, continued beyond the
/// discs: it moves along the axis by `drift` at most.
bool is_round(const FrustumPiece& f, const ToolMotion& m, double along_mm, double bend_mm) {
  const Extent e = extent(f);
  const double k = std::abs(slope(f)), widens = k * m.turn_rad;
  if (widens >= 0.5) return false;
  const double drift = (along_mm + m.turn_rad * e.radius_mm) / (1 - widens);
  const double radius = e.radius_mm + k * drift;
  const double across = least_across(m, e.z0_mm - drift, e.z1_mm + drift);
  const double along = along_mm + m.turn_rad * radius;
  return across * across - k * k * along * along >= bend_mm * radius * std::sqrt(1 + k * k);
}

/// Returns the number of parts of a slice whose ends may bend by `bend_mm`.
std::int64_t parts_of(double bend_mm, double tolerance_mm) {
  return parts(std::sqrt(bend_mm / (8 * kStationShare * tolerance_mm)));
}

/// Sets κ of a slice that turns by `m`, and its number of parts (kernel/sweep/README.md, "Number of
/// stations").
void plan_slice(PiecePlan& plan, const ToolMotion& m, double tolerance_mm) {
  const Extent e = extent(plan.piece);
  const AxisSpeeds v(m);
  const double nu = axial_normal(plan.piece);
  plan.bend_mm = 2 * m.turn_rad * (v.across * nu + v.along) +
                 m.turn_rad * m.turn_rad * (e.radius_mm + e.z1_mm * nu);
  plan.disc_bend_mm = 2 * m.turn_rad * v.across + m.turn_rad * m.turn_rad * e.z1_mm;
  if (plan.shows_edge) {
    plan.bend_mm = std::max(plan.bend_mm, plan.disc_bend_mm);
  } else if (const auto* f = std::get_if<FrustumPiece>(&plan.piece)) {
    plan.round = is_round(*f, m, v.along, plan.bend_mm);
  }
  if (!plan.round) plan.parts = parts_of(plan.bend_mm, tolerance_mm);
}

/// Returns the parameters of the search for the ends of a slice. Rays with a non-connected hit set
/// are bisected until a part bends by at most twice `missed_mm`.
SliceSearch search_of(const PiecePlan& plan, const ToolMotion& m, double tolerance_mm) {
  if (!(m.turn_rad > 0)) {
    return {
        .top_mm = plan.top_mm, .search_mm = kTranslationSearchMm, .shows_disc = plan.shows_edge};
  }
  const double missed = kStationShare * tolerance_mm;
  double bend = plan.bend_mm / (double(plan.parts) * double(plan.parts));
  int halvings = 0;
  for (; halvings < kHalvingsMax && bend > 2 * missed; bend /= 4) ++halvings;
  return {.parts = static_cast<int>(plan.parts),
          .halvings = halvings,
          .checked = !plan.round,
          .bend_mm = plan.bend_mm,
          .disc_bend_mm = plan.disc_bend_mm,
          .missed_mm = missed,
          .top_mm = plan.top_mm,
          .search_mm = kSearchShare * tolerance_mm,
          .shows_disc = plan.shows_edge};
}

std::vector<PiecePlan> plan_pieces(const Tool& tool, const ToolMotion& m,
                                   const SweepSettings& settings) {
  std::vector<PiecePlan> plans;
  for (std::size_t i = 0; i < tool.pieces.size(); ++i) {
    const ToolPiece& whole = tool.pieces[i];
    const auto piece = clip_to_block(whole, m, settings.block);
    if (!piece) continue;
    PiecePlan plan{
        .piece = *piece, .whole = whole, .which = i, .parts = 1, .top_mm = settings.block.max_mm.z};
    if (const auto* ball = std::get_if<BallPiece>(&*piece)) {
      plan.parts = parts(m.turn_rad * std::sqrt(ball->center_mm / (8 * settings.tolerance_mm)));
    } else {
      const Extent e = extent(whole);
      const ToolPiece* below = i > 0 ? &tool.pieces[i - 1] : nullptr;
      const ToolPiece* above = i + 1 < tool.pieces.size() ? &tool.pieces[i + 1] : nullptr;
      const bool clipped = extent(*piece).z1_mm < e.z1_mm;
      plan.shown = {!covers(below, e.z0_mm, radius_at(whole, e.z0_mm)),
                    !clipped && !covers(above, e.z1_mm, radius_at(whole, e.z1_mm)), clipped};
      const auto* arc = std::get_if<ArcPiece>(&whole);
      const bool edge_below = radius_at(whole, e.z0_mm) > kTipMm && !(arc && is_level_below(*arc));
      const bool edge_above = radius_at(whole, e.z1_mm) > kTipMm && !(arc && is_level_above(*arc));
      plan.shows_edge = (plan.shown.lower && edge_below) || (plan.shown.upper && edge_above);
      if (m.turn_rad > 0) plan_slice(plan, m, settings.tolerance_mm);
    }
    plans.push_back(plan);
  }
  return plans;
}

std::int64_t most_parts(const std::vector<PiecePlan>& plans) {
  return plans.empty() ? 1 : std::ranges::max(plans, {}, &PiecePlan::parts).parts;
}

ToolMotion part_of(const ToolMotion& m, double from_share, double to_share, double reach_mm) {
  return make_motion(m.at(from_share), m.at(to_share), reach_mm);
}

/// Returns all discs of a slice within the block through which points enter it, including hidden
/// ones.
ShownDiscs all_discs(const ToolPiece& slice, const ShownDiscs& shown) {
  const Extent e = extent(slice);
  return {radius_at(slice, e.z0_mm) > kTipMm,
          !shown.upper_is_outside && radius_at(slice, e.z1_mm) > kTipMm, shown.upper_is_outside};
}

SweptPiece sweep_slice(const PiecePlan& plan, const ToolMotion& m, const SweepSettings& settings) {
  const ToolPiece &piece = plan.piece, &whole = plan.whole;
  const ShownDiscs shown = plan.shown;
  const SliceSearch search = search_of(plan, m, settings.tolerance_mm);
  const auto trailing = [&](auto sweep) -> SweptPiece {
    if (settings.start_is_cut) {
      sweep.set_trail(Trail(piece, m.from, m.to, all_discs(piece, shown), shown));
    }
    return sweep;
  };
  if (m.turn_rad > 0) {
    return trailing(TurningSweep(piece, whole, m.from, m.to, shown, search));
  }
  if (const auto* f = std::get_if<FrustumPiece>(&piece)) {
    return trailing(
        FrustumTranslation(*f, std::get<FrustumPiece>(whole), m.from, m.to, shown, search));
  }
  return trailing(ArcTranslation(std::get<ArcPiece>(piece), std::get<ArcPiece>(whole), m.from, m.to,
                                 shown, search));
}

SweptPiece sweep_ball(const BallPiece& ball, const ToolMotion& m, std::int64_t n,
                      bool start_is_cut) {
  std::vector<Vec3> centers;
  for (std::int64_t i = 0; i <= n; ++i) {
    const ToolPose pose = i == n ? m.to : m.at(double(i) / double(n));
    centers.push_back(pose.tip_mm + pose.axis * ball.center_mm);
  }
  return BallSweep(centers, ball.radius_mm, start_is_cut);
}

SweptTool sweep_pieces(const Tool& tool, const std::vector<PiecePlan>& plans, const ToolMotion& m,
                       SweepSettings settings) {
  SweptTool swept;
  if (m.from == m.to) settings.start_is_cut = false;
  if (m.turn_rad > 0) swept.join_mm = std::max(swept.join_mm, settings.tolerance_mm);
  for (const PiecePlan& plan : plans) {
    // Above the last piece nothing could be left out.
    ToolAbove above;
    if (&plan != &plans.back()) above = ToolAbove(tool, plan.which, m, settings.block.max_mm.z);
    const auto* ball = std::get_if<BallPiece>(&plan.piece);
    swept.pieces.push_back(ball != nullptr ? sweep_ball(*ball, m, plan.parts, settings.start_is_cut)
                                           : sweep_slice(plan, m, settings));
    swept.above.push_back(above);
  }
  return swept;
}

/// Returns the number of parts of which each turns at most kTurnPerFrameMaxRad.
std::int64_t frames_of(const ToolMotion& m) { return parts(m.turn_rad / kTurnPerFrameMaxRad); }

/// The sweep of MotionModel::kTight.
class TightSweep {
 public:
  TightSweep(const Tool& tool, const ToolMotion& motion, const SweepSettings& settings)
      : tool_(tool), motion_(motion), settings_(settings), frames_(frames_of(motion)) {}

  std::int64_t count() const {
    std::int64_t sum = 0;
    for (std::int64_t i = 0; i < frames_; ++i) {
      sum += most_parts(plan_pieces(tool_, frame(i), settings_));
    }
    return sum;
  }

  template <class Visit>
  void run(const Visit& visit) {
    for (std::int64_t i = 0; i < frames_; ++i) {
      const ToolMotion m = frame(i);
      const std::vector<PiecePlan> plans = plan_pieces(tool_, m, settings_);
      emit(visit, plans, m, 1 / double(frames_), most_parts(plans));
    }
  }

 private:
  ToolMotion frame(std::int64_t i) const {
    if (frames_ == 1) return motion_;
    return part_of(motion_, double(i) / double(frames_), double(i + 1) / double(frames_),
                   tool_.length_mm);
  }
  template <class Visit>
  void emit(const Visit& visit, const std::vector<PiecePlan>& plans, const ToolMotion& m,
            double share, std::int64_t count) {
    visit({sweep_pieces(tool_, plans, m, settings_), m, share, count});
    settings_.start_is_cut = true;
  }

  const Tool& tool_;
  const ToolMotion& motion_;
  SweepSettings settings_;
  std::int64_t frames_;
};

std::int64_t paper_parts(const Tool& tool, const ToolMotion& m, const SweepSettings& settings) {
  if (m.turn_rad == 0) return 1;
  double reach = 0;
  for (const ToolPiece& whole : tool.pieces) {
    const auto piece = clip_to_block(whole, m, settings.block);
    if (piece) reach = std::max(reach, reach_of(*piece));
  }
  return parts(
      std::max(m.turn_rad * reach / settings.tolerance_mm, m.turn_rad / kTurnPerFrameMaxRad));
}

/// The sweep of MotionModel::kPaper, Eq. 12: in each part the translation with the axis at its
/// start, then the rotation about the tip at its end.
template <class Visit>
void sweep_as_paper(const Tool& tool, const ToolMotion& motion, SweepSettings settings,
                    const Visit& visit) {
  const std::int64_t n = paper_parts(tool, motion, settings);
  const double share = 1 / double(n);
  const auto emit = [&](const ToolMotion& m, double of_time) {
    visit({sweep_pieces(tool, plan_pieces(tool, m, settings), m, settings), m, of_time, 1});
    settings.start_is_cut = true;
  };
  if (motion.turn_rad == 0) return emit(motion, 1);
  for (std::int64_t i = 0; i < n; ++i) {
    const ToolPose from = motion.at(double(i) * share);
    const ToolPose to = i + 1 == n ? motion.to : motion.at(double(i + 1) * share);
    const ToolPose arrived{to.tip_mm, from.axis};
    const bool travels = motion.travel_mm > 0;
    if (travels) emit(make_motion(from, arrived, tool.length_mm), share / 2);
    emit(make_motion(arrived, to, tool.length_mm), travels ? share / 2 : share);
  }
}

}  // namespace

std::int64_t count_sub_motions(const Tool& tool, const ToolMotion& motion,
                               const SweepSettings& settings) {
  if (settings.model == MotionModel::kTight) return TightSweep(tool, motion, settings).count();
  const bool both = motion.turn_rad > 0 && motion.travel_mm > 0;
  return paper_parts(tool, motion, settings) * (both ? 2 : 1);
}

void sweep_tool(const Tool& tool, const ToolMotion& motion, const SweepSettings& given,
                const std::function<void(SubMotion&&)>& visit) {
  SweepSettings settings = given;
  if (!settings.start_is_cut && !(motion.from == motion.to)) {
    const ToolMotion rest = make_motion(motion.from, motion.from, tool.length_mm);
    visit({sweep_pieces(tool, plan_pieces(tool, rest, settings), rest, settings), rest, 1, 0});
  }
  settings.start_is_cut = true;
  if (settings.model == MotionModel::kTight) {
    TightSweep(tool, motion, settings).run(visit);
  } else {
    sweep_as_paper(tool, motion, settings, visit);
  }
}

}  // namespace kerf
