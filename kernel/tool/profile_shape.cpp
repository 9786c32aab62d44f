// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "kernel/tool/outline.h"
#include "kernel/tool/tool_check.h"

namespace kerf {
namespace {

using enum ToolErrorCode;

ProfilePoint end_of(const ProfileStep& step) {
  if (const auto* point = std::get_if<ProfilePoint>(&step)) return *point;
  if (const auto* arc = std::get_if<ProfileArc>(&step)) return arc->to;
  return std::get<ProfileCenteredArc>(step).to;
}

/// The segment between the ends of an arc: its middle, half its length, and its unit normal towards
/// the axis (for a segment that runs upwards).
struct Chord {
  ProfilePoint middle;
  double half;
  double nr, nh;
};

Chord chord_of(ProfilePoint a, ProfilePoint b) {
  const double dr = b.r_mm - a.r_mm, dh = b.h_mm - a.h_mm;
  const double n = std::hypot(dr, dh);
  return {{(a.r_mm + b.r_mm) / 2, (a.h_mm + b.h_mm) / 2}, n / 2, -dh / n, dr / n};
}

/// Returns the signed distance of an arc's center from its chord, positive towards the axis. The
/// field of an error is relative to the step.
std::expected<double, ToolError> offset(const ProfileArc& arc, const Chord& chord,
                                        ProfilePoint /*from*/) {
  if (auto c = check_length(".radius", arc.radius_mm); !c) return std::unexpected(c.error());
  if (chord.half - arc.radius_mm > kMissAllowanceMm) {
    return reject(kInconsistent, ".radius",
                  "is less than half the distance of the arc's ends, " +
                      std::to_string(2 * chord.half) + " mm");
  }
  const double square = (arc.radius_mm - chord.half) * (arc.radius_mm + chord.half);
  const double off = std::sqrt(std::max(0.0, square));
  return arc.bulge == ArcBulge::kOut ? off : -off;
}

std::expected<double, ToolError> offset(const ProfileCenteredArc& arc, const Chord& chord,
                                        ProfilePoint from) {
  const ProfilePoint c = arc.center;
  for (const double v : {c.r_mm, c.h_mm}) {
    if (auto check = check_coordinate(".center", v, -kToolLengthMaxMm); !check) {
      return std::unexpected(check.error());
    }
  }
  const double to_start = std::hypot(from.r_mm - c.r_mm, from.h_mm - c.h_mm);
  const double to_end = std::hypot(arc.to.r_mm - c.r_mm, arc.to.h_mm - c.h_mm);
  if (std::abs(to_start - to_end) > kMissAllowanceMm) {
    return reject(kInconsistent, ".center",
                  "is " + std::to_string(to_start) + " mm from the arc's start and " +
                      std::to_string(to_end) + " mm from its end");
  }
  // Projected on the chord's perpendicular bisector, so that the arc passes through both ends.
  const double off =
      (c.r_mm - chord.middle.r_mm) * chord.nr + (c.h_mm - chord.middle.h_mm) * chord.nh;
  if (arc.bulge == ArcBulge::kOut ? off < -kMissAllowanceMm : off > kMissAllowanceMm) {
    return reject(kInconsistent, ".center", "lies on the side to which the arc should bulge");
  }
  return off;
}

/// Returns the straight sections that replace an arc that bulges towards the axis: its tangents at
/// both ends and at equal angles in between. They are within the tool. Their corners are farthest
/// from the arc, by radius (1/cos(angle / 2) − 1). Returns nothing if more than kToolPiecesMax are
/// needed.
std::vector<OutlineSection> tangents(const OutlineArc& arc, double chord_tolerance_mm) {
  const auto angle = [&](ProfilePoint p) {
    return std::atan2(p.h_mm - arc.center.h_mm, arc.center.r_mm - p.r_mm);
  };
  const double from = angle(arc.from), whole = angle(arc.to) - from;
  const double half_max = std::atan(
      std::sqrt(chord_tolerance_mm * (2 * arc.radius_mm + chord_tolerance_mm)) / arc.radius_mm);
  const double n = std::max(1.0, std::ceil(whole / (2 * half_max)));
  if (n > double(kToolPiecesMax)) return {};
  const double corner = arc.radius_mm / std::cos(whole / (2 * n));
  std::vector<OutlineSection> lines;
  ProfilePoint at = arc.from;
  for (double k = 0; k < n; ++k) {
    const double a = from + whole * ((k + 0.5) / n);
    const ProfilePoint next{
        std::max(0.0, arc.center.r_mm - corner * std::cos(a)),
        std::clamp(arc.center.h_mm + corner * std::sin(a), at.h_mm, arc.to.h_mm)};
    lines.emplace_back(OutlineLine{at, next});
    at = next;
  }
  lines.emplace_back(OutlineLine{at, arc.to});
  return lines;
}

using Sections = std::expected<std::vector<OutlineSection>, ToolError>;

/// Returns the sections of an arc that starts at `from`.
template <typename Arc>
Sections sections_of(ProfilePoint from, const Arc& arc, double chord_tolerance_mm) {
  const ProfilePoint to = arc.to;
  if (std::hypot(to.r_mm - from.r_mm, to.h_mm - from.h_mm) <= kOutlineEpsilonMm) {
    return reject(kInconsistent, "", "must not be an arc that ends where it starts");
  }
  const Chord chord = chord_of(from, to);
  const auto off = offset(arc, chord, from);
  if (!off) return std::unexpected(off.error());
  const double radius = std::hypot(chord.half, *off);
  if (radius > kToolLengthMaxMm) {
    return reject(kOutOfRange, "", "must not be an arc with a radius of more than 5000 mm");
  }
  ProfilePoint center{chord.middle.r_mm + chord.nr * *off, chord.middle.h_mm + chord.nh * *off};
  if (std::abs(center.r_mm) <= kOutlineEpsilonMm) center.r_mm = 0;
  // Beyond the bottom or the top of its circle an arc would fall.
  const bool out = arc.bulge == ArcBulge::kOut;
  const auto beyond = [&](ProfilePoint p) {
    return out ? p.r_mm < center.r_mm : p.r_mm > center.r_mm;
  };
  const double dips = beyond(from) ? from.h_mm - (center.h_mm - radius) : 0;
  const double rises = beyond(to) ? (center.h_mm + radius) - to.h_mm : 0;
  if (dips > kMissAllowanceMm || rises > kMissAllowanceMm) {
    return reject(
        kInconsistent, "",
        std::string("must not be an arc that ") +
            (dips > kMissAllowanceMm ? "first falls below its start" : "falls before its end"));
  }
  const OutlineArc exact{from, to, center, radius};
  if (out) return std::vector<OutlineSection>{exact};
  auto lines = tangents(exact, chord_tolerance_mm);
  if (lines.empty())
    return reject(kTooManyPieces, "",
                  "needs more than " + std::to_string(kToolPiecesMax) +
                      " pieces; give a larger chord_tolerance_mm");
  return lines;
}

Sections sections_of(ProfilePoint from, const ProfilePoint& to, double /*chord_tolerance_mm*/) {
  return std::vector<OutlineSection>{OutlineLine{from, to}};
}

ToolCheck check_points(const ProfileShape& shape, const std::string& field) {
  if (shape.steps.size() < 2) {
    return reject(kTooShort, field, "must have at least two points");
  }
  if (shape.steps.size() > kToolPiecesMax) {
    return reject(kTooManyPieces, field, "has more than 1024 points");
  }
  if (!std::holds_alternative<ProfilePoint>(shape.steps.front())) {
    return reject(kInconsistent, field + "[0]", "must be a point, not an arc");
  }
  for (std::size_t i = 0; i < shape.steps.size(); ++i) {
    const ProfilePoint p = end_of(shape.steps[i]);
    const std::string name = field + "[" + std::to_string(i) + "]";
    for (const double v : {p.r_mm, p.h_mm}) {
      if (auto c = check_coordinate(name, v, 0); !c) return c;
    }
    if (i == 0 && p.h_mm != 0) return reject(kInconsistent, name, "must be at height 0, the tip");
    if (i > 0 && p.h_mm < end_of(shape.steps[i - 1]).h_mm) {
      return reject(kInconsistent, name, "is lower than the point before it");
    }
  }
  return check_length(field, end_of(shape.steps.back()).h_mm);
}

/// Returns whether a section has height but no radius, and hence no volume.
bool has_needle(const std::vector<OutlineSection>& sections) {
  return std::ranges::any_of(sections, [](const OutlineSection& section) {
    const auto* line = std::get_if<OutlineLine>(&section);
    return line != nullptr && line->to.h_mm - line->from.h_mm > kOutlineEpsilonMm &&
           std::max(line->from.r_mm, line->to.r_mm) < kToolLengthMinMm / 2;
  });
}

}  // namespace

Pieces resolve(const ProfileShape& shape, const std::string& prefix) {
  const std::string field = prefix + "profile_mm";
  if (auto c = check_points(shape, field); !c) return std::unexpected(c.error());
  if (!(shape.chord_tolerance_mm >= kChordToleranceMinMm &&
        shape.chord_tolerance_mm <= kChordToleranceMaxMm)) {
    return reject(kOutOfRange, prefix + "chord_tolerance_mm", "must be between 0.000001 and 1 mm");
  }
  std::vector<OutlineSection> outline;
  for (std::size_t i = 1; i < shape.steps.size(); ++i) {
    const ProfilePoint from = end_of(shape.steps[i - 1]);
    const std::string name = field + "[" + std::to_string(i) + "]";
    auto sections = std::visit(
        [&](const auto& step) { return sections_of(from, step, shape.chord_tolerance_mm); },
        shape.steps[i]);
    if (!sections) {
      return reject(sections.error().code, name + sections.error().field, sections.error().reason);
    }
    if (has_needle(*sections)) return reject(kInconsistent, name, "must not run along the axis");
    outline.insert(outline.end(), sections->begin(), sections->end());
  }
  auto pieces = pieces_of(outline);
  if (auto c = check_pieces(field, pieces); !c) return std::unexpected(c.error());
  return pieces;
}

}  // namespace kerf
