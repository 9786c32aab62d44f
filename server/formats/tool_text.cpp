// SPDX-License-Identifier: Apache-2.0
#include "server/formats/tool_text.h"

#include <variant>

#include "server/formats/number_text.h"

namespace kerf {
namespace {

std::string size_text(double diameter_mm, double length_mm) {
  return "diameter " + exact_text(diameter_mm) + " mm, length " + exact_text(length_mm) + " mm";
}

struct Describe {
  std::string operator()(const BallShape& s) const {
    return "ball, " + size_text(s.diameter_mm, s.length_mm);
  }
  std::string operator()(const FlatShape& s) const {
    return "flat, " + size_text(s.diameter_mm, s.length_mm);
  }
  std::string operator()(const TaperShape& s) const {
    const std::string tip = s.tip == TaperTip::kBall ? "ball" : "flat";
    return "taper with " + tip + " tip, " + size_text(s.diameter_mm, s.length_mm) +
           ", half angle " + exact_text(s.half_angle_deg) + " degrees";
  }
  std::string operator()(const ConeEndShape& s) const {
    return "cone end, " + size_text(s.diameter_mm, s.length_mm) + ", tip angle " +
           exact_text(s.tip_angle_deg) + " degrees";
  }
  std::string operator()(const BullNoseShape& s) const {
    return "bull nose, " + size_text(s.diameter_mm, s.length_mm) + ", corner radius " +
           exact_text(s.corner_radius_mm) + " mm";
  }
  std::string operator()(const AptShape& s) const {
    std::string text = "APT cutter ";
    for (const double v : {s.d_mm, s.r_mm, s.e_mm, s.f_mm, s.alpha_deg, s.beta_deg}) {
      text += exact_text(v);
      text += ',';
    }
    return text + exact_text(s.h_mm);
  }
  std::string operator()(const ProfileShape& s) const {
    return "profile of " + std::to_string(s.steps.size()) + " points, length " +
           exact_text(cutting_length_mm(s)) + " mm";
  }
};

constexpr std::size_t kOutlineMax = 140;

std::string point_text(const ProfilePoint& point) {
  return exact_text(point.r_mm) + ' ' + exact_text(point.h_mm);
}

std::string bulge_text(ArcBulge bulge) { return bulge == ArcBulge::kOut ? " out" : " in"; }

struct StepText {
  std::string operator()(const ProfilePoint& point) const { return point_text(point); }
  std::string operator()(const ProfileArc& arc) const {
    return point_text(arc.to) + " radius " + exact_text(arc.radius_mm) + bulge_text(arc.bulge);
  }
  std::string operator()(const ProfileCenteredArc& arc) const {
    return point_text(arc.to) + " about " + point_text(arc.center) + bulge_text(arc.bulge);
  }
};

}  // namespace

std::string tool_text(const ToolShape& shape) { return std::visit(Describe{}, shape); }

std::vector<std::string> tool_comments(ToolId id, const ToolShape& shape) {
  const std::string number = "T" + std::to_string(id);
  std::vector<std::string> comments{number + ": " + tool_text(shape)};
  const auto* profile = std::get_if<ProfileShape>(&shape);
  if (profile == nullptr) return comments;
  comments.front() += ", chord tolerance " + exact_text(profile->chord_tolerance_mm) + " mm";
  const std::string head = number + " outline: ";
  for (const ProfileStep& step : profile->steps) {
    const std::string text = std::visit(StepText{}, step);
    if (comments.size() == 1 || comments.back().size() + text.size() > kOutlineMax) {
      comments.push_back(head + text);
    } else {
      comments.back() += ", " + text;
    }
  }
  return comments;
}

}  // namespace kerf
