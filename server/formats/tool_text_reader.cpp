// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cmath>
#include <string>

#include "kernel/tool/tool.h"
#include "server/formats/letter_case.h"
#include "server/formats/tool_text.h"

namespace kerf {
namespace {

// Reads the text of tool_text in upper case, word by word.
class ToolText {
 public:
  explicit ToolText(std::string_view text) : text_(to_upper(std::string(text))), rest_(text_) {}

  // Skips a text, if it is next.
  bool skip(std::string_view text) {
    if (!rest_.starts_with(text)) return false;
    rest_.remove_prefix(text.size());
    return true;
  }
  std::optional<double> number() {
    double value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }
  // A number between two texts.
  bool number(std::string_view before, double& value, std::string_view after) {
    if (!skip(before)) return false;
    const auto read = number();
    if (!read) return false;
    value = *read;
    return skip(after);
  }
  bool sizes(double& diameter, double& length) {
    return number("DIAMETER ", diameter, " MM, ") && number("LENGTH ", length, " MM");
  }
  bool ends() const { return rest_.find_first_not_of(" \t\r") == std::string_view::npos; }

 private:
  std::string text_;
  std::string_view rest_;
};

std::optional<ToolShape> taper_of(ToolText& text) {
  TaperShape s{};
  s.tip = text.skip("BALL") ? TaperTip::kBall : TaperTip::kFlat;
  if (s.tip == TaperTip::kFlat && !text.skip("FLAT")) return std::nullopt;
  if (!text.skip(" TIP, ") || !text.sizes(s.diameter_mm, s.length_mm)) return std::nullopt;
  if (!text.number(", HALF ANGLE ", s.half_angle_deg, " DEGREES")) return std::nullopt;
  return s;
}

std::optional<ToolShape> apt_of(ToolText& text) {
  AptShape s{};
  double* const values[] = {&s.d_mm, &s.r_mm, &s.e_mm, &s.f_mm, &s.alpha_deg, &s.beta_deg, &s.h_mm};
  for (double* value : values)
    if (!text.number("", *value, value == &s.h_mm ? "" : ",")) return std::nullopt;
  return s;
}

std::optional<ProfileStep> step_of(ToolText& text) {
  ProfilePoint to{};
  if (!text.number("", to.r_mm, " ") || !text.number("", to.h_mm, "")) return std::nullopt;
  double radius = 0;
  ProfilePoint center{};
  const bool arc = text.number(" RADIUS ", radius, "");
  const bool about =
      !arc && text.number(" ABOUT ", center.r_mm, " ") && text.number("", center.h_mm, "");
  if (!arc && !about) return to;
  const bool out = text.skip(" OUT");
  if (!out && !text.skip(" IN")) return std::nullopt;
  const ArcBulge bulge = out ? ArcBulge::kOut : ArcBulge::kIn;
  if (arc) return ProfileArc{to, radius, bulge};
  return ProfileCenteredArc{to, center, bulge};
}

std::optional<ToolShape> profile_of(ToolText& text, std::string_view outline) {
  double points = 0, length = 0;
  ProfileShape s;
  if (!text.number("", points, " POINTS, ") || !text.number("LENGTH ", length, " MM") ||
      !text.number(", CHORD TOLERANCE ", s.chord_tolerance_mm, " MM"))
    return std::nullopt;
  ToolText steps(outline);
  do {
    const auto step = step_of(steps);
    if (!step) return std::nullopt;
    s.steps.push_back(*step);
  } while (steps.skip(", "));
  if (!steps.ends() || static_cast<double>(s.steps.size()) != points) return std::nullopt;
  return s;
}

std::optional<ToolShape> shape_of(ToolText& text, std::string_view outline) {
  double d = 0, length = 0, more = 0;
  if (text.skip("BALL, ")) {
    if (text.sizes(d, length)) return BallShape{d, length};
  } else if (text.skip("FLAT, ")) {
    if (text.sizes(d, length)) return FlatShape{d, length};
  } else if (text.skip("CONE END, ")) {
    if (text.sizes(d, length) && text.number(", TIP ANGLE ", more, " DEGREES"))
      return ConeEndShape{d, more, length};
  } else if (text.skip("BULL NOSE, ")) {
    if (text.sizes(d, length) && text.number(", CORNER RADIUS ", more, " MM"))
      return BullNoseShape{d, more, length};
  } else if (text.skip("TAPER WITH ")) {
    return taper_of(text);
  } else if (text.skip("APT CUTTER ")) {
    return apt_of(text);
  } else if (text.skip("PROFILE OF ")) {
    return profile_of(text, outline);
  }
  return std::nullopt;
}

}  // namespace

bool ExportedTools::add(ToolId id, std::string_view text, std::optional<ToolShape>& shape) {
  constexpr std::string_view kTool = ": ", kOutline = " OUTLINE: ";
  Texts& texts = texts_[id];
  const bool continues = to_upper(std::string(text.substr(0, kOutline.size()))) == kOutline;
  if (continues) {
    if (!texts.outline.empty()) texts.outline += ", ";
    texts.outline += text.substr(kOutline.size());
  } else if (text.starts_with(kTool)) {
    texts = {std::string(text.substr(kTool.size())), {}};
  } else {
    return false;
  }
  ToolText reader(texts.tool);
  shape = shape_of(reader, texts.outline);
  if (!reader.ends() || (shape && !make_tool(*shape))) shape.reset();
  return shape || continues;
}

}  // namespace kerf
