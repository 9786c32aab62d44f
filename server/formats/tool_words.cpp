// SPDX-License-Identifier: Apache-2.0
#include "server/formats/tool_words.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "server/formats/number_text.h"
#include "server/formats/tool_facts.h"
#include "server/formats/tool_tokens.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr double kDrillDeg = 118, kSpotDeg = 90, kEngraverDeg = 60, kEngraverMm = 10;
/// Greatest angle that is taken as that of a chamfer mill's side, unless it is named.
constexpr double kChamferSideDeg = 45;
constexpr double kLengthDiameters = 5, kLengthMinMm = 20;
/// Greatest plausible diameter, mm: face mills and fly cutters.
constexpr double kDiameterMaxMm = 500;
/// Sizes without a unit beyond these are probably in inches (mm).
constexpr double kBareMinMm = 1, kBareMaxMm = 100;
/// Sizes that differ by less are equal, written as a fraction and as a decimal.
constexpr double kSameShare = 0.005;

bool is_same(double a, double b) { return std::abs(a - b) <= kSameShare * std::max(a, b); }

double usual_length(double d) { return std::max(kLengthMinMm, kLengthDiameters * d); }

ToolShape cone(double d, double tip_deg) {
  return with_cutting_length(ConeEndShape{d, tip_deg, usual_length(d)}, usual_length(d));
}

// Combines the facts of a comment into a shape.
class Combination {
 public:
  Combination(const ToolFacts& facts, double unit_mm) : facts_(facts), unit_mm_(unit_mm) {}

  std::optional<WordedTool> tool() {
    if (facts_.has(ToolWord::kNegation) || facts_.has(ToolWord::kOperation)) return std::nullopt;
    if (families() > 1) return std::nullopt;
    if (!find_diameter()) return std::nullopt;
    if (!(d_ > 0) || d_ > kDiameterMaxMm) return std::nullopt;
    if (!facts_.unread.empty()) {
      if (std::ranges::all_of(facts_.sizes,
                              [](const ToolFacts::Size& size) { return rank(size) == 0; }))
        return std::nullopt;
      doubt("\"" + facts_.unread.front() + "\" is not understood");
    }
    const ToolShape shape = shape_of();
    if (!doubt_.empty()) origins_ = {};
    const bool noun =
        facts_.has(Word::kMill) || facts_.has(Word::kEnd) || facts_.has(Word::kBit) || is_drill();
    return WordedTool{.shape = shape,
                      .origins = origins_,
                      .doubt = doubt_,
                      .names_kind = names_kind() || noun,
                      .names_tool = noun || has_noun(),
                      .sized = is_sure_size(),
                      .has_length = facts_.has_length};
  }

 private:
  using Word = ToolWord;

  // Whether there is a noun that does not also name an operation, as FACE, SLOT and CHAMFER do.
  bool has_noun() const {
    return facts_.has(Word::kTool) || facts_.has(Word::kBall) || facts_.has(Word::kBull) ||
           facts_.has(Word::kTap) || facts_.has(Word::kReamer) || facts_.has(Word::kCountersink);
  }
  void doubt(const std::string& why) {
    if (doubt_.empty()) doubt_ = why;
  }

  bool is_drill() const {
    return (facts_.has(Word::kDrill) || facts_.has(Word::kSpot)) && !facts_.has(Word::kSlot);
  }
  bool is_vee() const {
    return facts_.has(Word::kVee) || facts_.has(Word::kChamfer) || facts_.has(Word::kCountersink);
  }
  bool is_flat() const {
    return facts_.has(Word::kFlat) || facts_.has(Word::kFace) || facts_.has(Word::kSlot) ||
           facts_.has(Word::kTap) || facts_.has(Word::kReamer);
  }
  bool is_form() const {
    return facts_.has(Word::kForm) || facts_.has(Word::kTurning) || facts_.has(Word::kThread);
  }
  bool names_kind() const {
    return is_drill() || is_vee() || is_flat() || is_form() || facts_.has(Word::kBall) ||
           facts_.has(Word::kBull) || facts_.has(Word::kTaper);
  }

  // Kinds that exclude each other. A drill may countersink. An end mill drills only as a slot
  // drill.
  int families() const {
    const bool mills = facts_.has(Word::kEnd) || facts_.has(Word::kMill);
    const bool drills = is_drill() && !is_vee();
    return (facts_.has(Word::kBall) ? 1 : 0) + (facts_.has(Word::kBull) ? 1 : 0) +
           (is_flat() || (drills && mills) ? 1 : 0) + (is_drill() || is_vee() ? 1 : 0);
  }

  // Finds the size with a name, else with a unit, else before the kind, else the only one. All
  // others must be equal; next to one of these, a bare number that differs is not understood.
  bool find_diameter() {
    const ToolFacts::Size* best = nullptr;
    for (const ToolFacts::Size& size : facts_.sizes)
      if (best == nullptr || rank(size) > rank(*best)) best = &size;
    if (best != nullptr) {
      for (const ToolFacts::Size& size : facts_.sizes)
        if (!is_same(size.mm, best->mm)) {
          if (rank(size) == rank(*best) || size.named || size.with_unit) return false;
          doubt("\"" + decimal_text(size.mm / unit_mm_, 4) + "\" is not understood");
        }
      if (is_of_another_unit(*best)) return false;
      d_ = best->mm;
      origins_.diameter = best->with_unit ? Origin::kStated : Origin::kDerived;
      return true;
    }
    if (facts_.has(Word::kBall) && facts_.radius_mm) {
      d_ = 2 * *facts_.radius_mm;
      origins_.diameter = Origin::kDerived;
      return true;
    }
    d_ = kEngraverMm;
    return facts_.has(Word::kVee) && facts_.sizes.empty() &&
           (facts_.angle_deg || facts_.has(Word::kMill) || facts_.has(Word::kBit));
  }
  // ".5 END MILL" in a program in mm, "D6" in one in inches.
  bool is_of_another_unit(const ToolFacts::Size& size) const {
    if (size.with_unit) return false;
    return unit_mm_ == 1 ? !size.named && size.mm < kBareMinMm : size.mm > kBareMaxMm;
  }
  static int rank(const ToolFacts::Size& size) {
    return (size.named ? 4 : 0) + (size.with_unit ? 2 : 0) + (size.before_kind ? 1 : 0);
  }
  bool is_sure_size() const {
    return std::ranges::any_of(
        facts_.sizes, [](const ToolFacts::Size& size) { return size.named || size.with_unit; });
  }

  ToolShape shape_of() {
    if (is_form()) {
      doubt("the outline of such a tool is not stated");
      return FlatShape{d_, usual_length(d_)};
    }
    const bool flat_enough = facts_.has(Word::kTap) || facts_.has(Word::kReamer);
    if (names_kind()) origins_.shape = flat_enough ? Origin::kDerived : Origin::kStated;
    if (!names_kind() && facts_.has(Word::kEnd)) origins_.shape = Origin::kDerived;
    if (is_drill() || is_vee()) return pointed();
    return rounded();
  }

  ToolShape pointed() {
    if (facts_.radius_mm.value_or(0) > 0 || facts_.corner_mm.value_or(0) > 0)
      doubt("a rounded tip is not modeled");
    const bool chamfers = facts_.has(Word::kChamfer) || facts_.has(Word::kCountersink);
    const bool drills = is_drill();
    double tip = drills ? (facts_.has(Word::kSpot) ? kSpotDeg : kDrillDeg)
                        : (chamfers ? kSpotDeg : kEngraverDeg);
    if (facts_.angle_deg) {
      const double stated = *facts_.angle_deg;
      const bool of_side =
          facts_.angle_of_side
              ? !drills || is_vee()
              : facts_.has(Word::kChamfer) && !facts_.angle_of_point && stated <= kChamferSideDeg;
      tip = of_side ? 2 * stated : stated;
      origins_.angle = of_side ? Origin::kDerived : Origin::kStated;
    }
    if (!(tip > 0 && tip < 180)) {
      doubt("an angle of " + exact_text(tip) + " degrees is not that of a tip");
      return FlatShape{d_, usual_length(d_)};
    }
    return cone(d_, tip);
  }

  ToolShape rounded() {
    const double length = usual_length(d_);
    const bool ball = facts_.has(Word::kBall);
    double corner = facts_.corner_mm.value_or(facts_.radius_mm.value_or(ball ? d_ / 2 : 0));
    if (ball && !is_same(corner, d_ / 2)) {
      if (corner > 0) doubt("the radius is not half of the diameter");
      corner = d_ / 2;
    }
    if (facts_.has(Word::kBull) && corner == 0) doubt("the corner radius is not stated");
    if (corner > d_ / 2 * (1 + kSameShare)) {
      doubt("the corner radius is greater than half of the diameter");
      corner = 0;
    }
    if (corner > 0 && is_same(corner, d_ / 2)) corner = d_ / 2;
    const bool stated = facts_.corner_mm || facts_.radius_mm;
    origins_.corner = stated ? Origin::kStated : Origin::kDerived;
    if (stated && origins_.shape == Origin::kAssumed) origins_.shape = Origin::kDerived;
    if (const auto side = side_deg()) {
      origins_.angle = Origin::kStated;
      if (corner > 0 && corner < d_ / 2) doubt("a taper with such a corner is not modeled");
      return TaperShape{d_, *side, length, corner > 0 ? TaperTip::kBall : TaperTip::kFlat};
    }
    if (corner == d_ / 2) return BallShape{d_, length};
    if (corner > 0) return BullNoseShape{d_, corner, length};
    return FlatShape{d_, length};
  }

  // The angle of a taper's side. For other tools an angle is not part of the shape.
  std::optional<double> side_deg() {
    const double deg = facts_.angle_deg.value_or(0);
    const bool tapers = facts_.has(Word::kTaper);
    if (deg == 0) {
      if (tapers && !facts_.angle_deg) doubt("the angle of the taper is not stated");
      return std::nullopt;
    }
    if (!tapers) doubt("an angle is no part of such a tool");
    if (tapers && deg < kChamferSideDeg) return deg;
    if (tapers) doubt("the angle is not that of a taper");
    return std::nullopt;
  }

  const ToolFacts& facts_;
  double unit_mm_;
  double d_ = 0;
  ToolOrigins origins_;
  std::string doubt_;
};

// Carbide Motion and MeshCAM: TOOL/MILL,diameter,corner radius,height,angle of the side. nullopt:
// the words are none of theirs.
std::optional<WordedTool> tool_of_carbide(std::string_view words, double unit_mm) {
  const std::vector<ToolToken> tokens = tool_tokens(words);
  if (tokens.size() < 6 || tokens[0].word != "TOOL" || tokens[1].word != "/") return {};
  std::vector<double> values;
  for (const ToolToken& token : tokens)
    if (token.is_number()) values.push_back(token.value);
  if (values.size() < 3 || !(values[0] > 0)) return {};
  const double d = values[0] * unit_mm, corner = values[1] * unit_mm, height = values[2] * unit_mm;
  const double side = values.size() > 3 ? values[3] : 0;
  const double length = std::max(usual_length(d), height);
  WordedTool tool{.shape = FlatShape{d, length},
                  .origins = {Origin::kDerived, Origin::kStated, Origin::kStated, Origin::kStated},
                  .names_kind = true,
                  .names_tool = true,
                  .sized = true};
  const bool round = corner > 0 && is_same(corner, d / 2);
  if (corner > d / 2 && !round) return {};
  if (side > 0 && side < 90) {
    if (corner > 0 && !round) return {};
    tool.shape =
        TaperShape{d, side, std::max(length, d), round ? TaperTip::kBall : TaperTip::kFlat};
  } else if (round) {
    tool.shape = BallShape{d, length};
  } else if (corner > 0) {
    tool.shape = BullNoseShape{d, corner, length};
  }
  return tool;
}

}  // namespace

const char* to_string(Origin origin) {
  switch (origin) {
    case Origin::kStated:
      return "stated";
    case Origin::kDerived:
      return "derived";
    default:
      return "assumed";
  }
}

std::optional<WordedTool> tool_of_words(std::string_view words, double unit_mm) {
  if (auto carbide = tool_of_carbide(words, unit_mm)) return carbide;
  const ToolFacts facts = read_tool_facts(words, unit_mm);
  return Combination(facts, unit_mm).tool();
}

std::optional<ToolShape> tool_of_exact_words(std::string_view words) {
  const auto tool = tool_of_words(words, 1);
  if (!tool || !tool->doubt.empty() || tool->has_length) return std::nullopt;
  return tool->shape;
}

ToolShape drill_shape(double diameter_mm, double tip_deg) { return cone(diameter_mm, tip_deg); }

ToolShape with_cutting_length(ToolShape shape, double length_mm) {
  if (auto* ball = std::get_if<BallShape>(&shape)) {
    ball->length_mm = std::max(length_mm, ball->diameter_mm / 2);
  } else if (auto* flat = std::get_if<FlatShape>(&shape)) {
    flat->length_mm = length_mm;
  } else if (auto* bull = std::get_if<BullNoseShape>(&shape)) {
    bull->length_mm = std::max(length_mm, bull->corner_radius_mm);
  } else if (auto* taper = std::get_if<TaperShape>(&shape)) {
    taper->length_mm = std::max(length_mm, taper->diameter_mm);
  } else if (auto* cone = std::get_if<ConeEndShape>(&shape)) {
    const double tip_mm = cone->diameter_mm / 2 / std::tan(cone->tip_angle_deg / 2 * kRadPerDeg);
    cone->length_mm = std::max(length_mm, 1.01 * tip_mm);
  }
  return shape;
}

}  // namespace kerf
