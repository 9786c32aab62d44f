// SPDX-License-Identifier: Apache-2.0
#include "server/formats/tool_text.h"

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

}  // namespace

std::string tool_text(const ToolShape& shape) { return std::visit(Describe{}, shape); }

}  // namespace kerf
