// SPDX-License-Identifier: Apache-2.0
#include "server/formats/tool_words.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "server/formats/tool_tokens.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr double kDrillDeg = 118, kSpotDeg = 90, kEngraverDeg = 60, kEngraverMm = 10;
constexpr double kLengthDiameters = 5, kLengthMinMm = 20;
/// Greatest diameter that is believed, mm: face mills and fly cutters.
constexpr double kDiameterMaxMm = 500;

using Token = ToolToken;

constexpr std::string_view kBall[] = {"BALL",  "BALLNOSE", "BALLNOSED", "BALLMILL", "SPHERICAL",
                                      "KUGEL", "KUGELFR",  "ESFERICA",  "SPHERE"};
constexpr std::string_view kBull[] = {"BULL", "BULLNOSE", "TORUS", "TOROIDAL", "BN"};
constexpr std::string_view kSpot[] = {"SPOT", "SPOTDRILL", "CENTER", "CENTRE", "CENTERDRILL"};
constexpr std::string_view kDrill[] = {"DRILL", "DRILLING", "BOHRER", "BROCA", "FORET", "TWIST"};
constexpr std::string_view kEngraver[] = {"ENGRAVE", "ENGRAVING", "ENGRAVER", "CHAMFER",    "VBIT",
                                          "VBITS",   "VCARVE",    "VCUTTER",  "COUNTERSINK"};
constexpr std::string_view kFlat[] = {
    "END",         "ENDMILL", "ENDMILLS",    "FLAT",    "SQUARE", "FACE",  "FACEMILL",
    "MILL",        "SLOT",    "SLOTDRILL",   "CUTTER",  "ROUTER", "FRESA", "FRAISE",
    "SCHAFTFR",    "EM",      "UPCUT",       "DOWNCUT", "REAMER", "TAP",   "CYLINDER",
    "CYLINDRICAL", "FR",      "COMPRESSION", "BIT"};

constexpr std::string_view kTap[] = {"TAP", "THREAD", "THREADMILL"};

template <std::size_t N>
bool any_of(const std::vector<Token>& tokens, const std::string_view (&words)[N]) {
  return std::ranges::any_of(tokens, [&](const Token& token) {
    return std::ranges::find(words, std::string_view(token.word)) != std::end(words);
  });
}

// "V" "-" "BIT" and the like.
bool is_v_bit(const std::vector<Token>& tokens) {
  for (std::size_t i = 0; i + 1 < tokens.size(); ++i) {
    if (tokens[i].word != "V") continue;
    const std::size_t next = tokens[i + 1].word == "-" ? i + 2 : i + 1;
    if (next < tokens.size() && (tokens[next].word == "BIT" || tokens[next].word == "CARVE"))
      return true;
  }
  return any_of(tokens, kEngraver);
}

bool is_noun(const Token& token) {
  const std::vector<Token> one{token};
  return any_of(one, kBall) || any_of(one, kBull) || any_of(one, kSpot) || any_of(one, kDrill) ||
         any_of(one, kEngraver) || any_of(one, kFlat);
}

// Whether a word or sign says something of a tool that tool_of_words reads, or nothing of it.
bool is_understood(const std::vector<Token>& tokens, std::size_t i) {
  const Token& token = tokens[i];
  if (token.is_number() || is_noun(token)) return true;
  const bool between = i > 0 && i + 1 < tokens.size();
  if (token.word == ",") return between;
  if (token.word == "-") return between && !tokens[i - 1].is_number() && !tokens[i + 1].is_number();
  if (token.word == "=") return between && tokens[i + 1].is_number() && !tokens[i - 1].is_number();
  if (token.word == "M") return any_of(tokens, kTap);
  const auto words = {"D",     "DIA",    "DIAM", "DIAMETER", "\xC3\x98", "CR",
                      "RE",    "CORNER", "TIP",  "R",        "RAD",      "RADIUS",
                      "TAPER", "V",      "NOSE", "FLUTE",    "FLUTES",   "TOOL"};
  return std::ranges::find(words, std::string_view(token.word)) != words.end();
}

class Description {
 public:
  Description(std::vector<Token> tokens, double unit_mm)
      : tokens_(std::move(tokens)), unit_mm_(unit_mm) {}

  std::optional<ToolShape> shape() const {
    if (const auto carbide = of_carbide()) return carbide;
    const bool engraves = is_v_bit(tokens_);
    const auto diameter = engraves && !diameter_mm() ? std::optional(kEngraverMm) : diameter_mm();
    if (!diameter || !(*diameter > 0) || *diameter > kDiameterMaxMm) return std::nullopt;
    if (engraves && !any_of(tokens_, kEngraver) && !angle_deg()) return std::nullopt;
    return of(*diameter, engraves);
  }

  // Whether every number has a meaning: the size, the corner, the angle or the flutes.
  bool uses_all_numbers(const ToolShape& shape) const {
    std::size_t meant = diameter_mm() ? 1 : 0;
    const bool round =
        !std::holds_alternative<FlatShape>(shape) && !std::holds_alternative<ConeEndShape>(shape);
    const bool sloped =
        std::holds_alternative<TaperShape>(shape) || std::holds_alternative<ConeEndShape>(shape);
    const bool taper = after({"TAPER"}, true).has_value();
    if (round && corner_mm()) ++meant;
    if (sloped && (taper || angle_deg())) ++meant;
    for (std::size_t i = 0; i + 1 < tokens_.size(); ++i)
      if (tokens_[i].is_number() && tokens_[i + 1].word.starts_with("FLUTE")) ++meant;
    const auto numbers = std::ranges::count_if(tokens_, &Token::is_number);
    return std::cmp_equal(meant, numbers);
  }

 private:
  ToolShape of(double d, bool engraves) const {
    const double length = std::max(kLengthMinMm, kLengthDiameters * d);
    const std::optional<double> taper = after({"TAPER"}, true);
    if (engraves) {
      const double tip = taper ? 2 * *taper : angle_deg().value_or(kEngraverDeg);
      return cone(d, tip, length);
    }
    if (any_of(tokens_, kDrill) && !any_of(tokens_, kFlat)) {
      const double usual = any_of(tokens_, kSpot) ? kSpotDeg : kDrillDeg;
      return cone(d, taper.value_or(angle_deg().value_or(usual)), length);
    }
    double corner = corner_mm().value_or(0);
    if (any_of(tokens_, kBall) || corner >= d / 2 - 1e-6) corner = d / 2;
    if (taper && *taper > 0 && *taper < 45)
      return TaperShape{d, *taper, length, corner > 0 ? TaperTip::kBall : TaperTip::kFlat};
    if (corner == d / 2) return BallShape{d, length};
    if (corner > 0) return BullNoseShape{d, corner, length};
    return FlatShape{d, length};
  }

  static ToolShape cone(double d, double tip_deg, double length) {
    if (!(tip_deg > 0 && tip_deg < 180)) return FlatShape{d, length};
    return with_cutting_length(ConeEndShape{d, tip_deg, length}, length);
  }

  // Carbide Motion and MeshCAM: TOOL/MILL,diameter,corner radius,height,angle of the side.
  std::optional<ToolShape> of_carbide() const {
    if (tokens_.size() < 11 || tokens_[0].word != "TOOL" || tokens_[1].word != "/") return {};
    std::vector<double> values;
    for (const Token& token : tokens_)
      if (token.is_number()) values.push_back(token.value);
    if (values.size() < 4 || !(values[0] > 0)) return {};
    const double d = values[0] * unit_mm_, corner = values[1] * unit_mm_;
    const double length = std::max(kLengthMinMm, kLengthDiameters * d);
    if (values[3] > 0 && corner == 0) return cone(d, 2 * values[3], length);
    if (corner >= d / 2 - 1e-6) return BallShape{d, length};
    if (corner > 0) return BullNoseShape{d, corner, length};
    return FlatShape{d, length};
  }

  double mm(const Token& token) const {
    const double unit = token.unit_mm > 0 ? token.unit_mm : unit_mm_;
    return std::round(token.value * unit * 1e6) / 1e6;
  }

  static bool is_sign(const Token& token) {
    return token.word.size() == 1 &&
           std::string_view("=:.-+").find(token.word) != std::string_view::npos;
  }

  // The number behind a word and signs such as "=", ":" and "-".
  const Token* number_after(std::size_t i) const {
    for (++i; i < tokens_.size(); ++i) {
      if (tokens_[i].is_number()) return &tokens_[i];
      if (!is_sign(tokens_[i])) return nullptr;
    }
    return nullptr;
  }

  std::optional<double> after(std::initializer_list<std::string_view> keys, bool plain) const {
    for (std::size_t i = 0; i < tokens_.size(); ++i) {
      if (std::ranges::find(keys, std::string_view(tokens_[i].word)) == keys.end()) continue;
      const Token* const number = number_after(i);
      if (number && (plain || !number->degrees)) return plain ? number->value : mm(*number);
    }
    return std::nullopt;
  }

  std::optional<double> angle_deg() const {
    for (const Token& token : tokens_)
      if (token.is_number() && token.degrees) return token.value;
    return std::nullopt;
  }

  std::optional<double> corner_mm() const {
    if (const auto corner = after({"CR", "RE"}, false)) return corner;
    for (std::size_t i = 0; i + 1 < tokens_.size(); ++i)
      if (tokens_[i].word == "CORNER" || tokens_[i].word == "TIP")
        for (const std::string_view key : {"RADIUS", "RAD", "R"})
          if (tokens_[i + 1].word == key)
            if (const Token* number = number_after(i + 1)) return mm(*number);
    return any_of(tokens_, kBull) ? after({"R", "RAD", "RADIUS"}, false) : std::nullopt;
  }

  std::optional<double> diameter_mm() const {
    using Words = std::initializer_list<std::string_view>;
    const Words keys = {"DIA", "DIAM", "DIAMETER", "DIAMETRO", "DURCHMESSER", "\xC3\x98", "\xD8"};
    if (const auto stated = after(keys, false)) return stated;
    for (std::size_t i = 0; i + 2 < tokens_.size(); ++i)
      if (tokens_[i].word == "D" && (tokens_[i + 1].word == "=" || tokens_[i + 1].word == ":"))
        if (const Token* number = number_after(i); number && !number->degrees) return mm(*number);
    if (const auto thread = thread_mm()) return thread;
    for (std::size_t i = 0; i + 1 < tokens_.size(); ++i)
      if (is_size(i) && is_noun(tokens_[i + 1])) return mm(tokens_[i]);
    for (std::size_t i = 0; i < tokens_.size(); ++i)
      if (is_size(i) && tokens_[i].unit_mm > 0) return mm(tokens_[i]);
    const bool registers = std::ranges::any_of(
        tokens_, [](const Token& token) { return token.word == "H" || token.word == "|"; });
    for (std::size_t i = 0; i + 1 < tokens_.size() && !registers; ++i)
      if (tokens_[i].word == "D" && tokens_[i + 1].is_number()) return mm(tokens_[i + 1]);
    return std::nullopt;
  }

  // M10 of a tap.
  std::optional<double> thread_mm() const {
    if (!any_of(tokens_, kTap)) return std::nullopt;
    for (std::size_t i = 0; i + 1 < tokens_.size(); ++i)
      if (tokens_[i].word == "M" && tokens_[i + 1].is_number()) return tokens_[i + 1].value;
    return std::nullopt;
  }

  // Not an angle, a length, the 30 of "6x30" or the 16 of "3/8-16 TAP".
  bool is_size(std::size_t i) const {
    if (!tokens_[i].is_number() || tokens_[i].degrees || is_length(i)) return false;
    if (i < 2 || !tokens_[i - 2].is_number()) return true;
    const std::string& between = tokens_[i - 1].word;
    const bool pitch = between == "-" && tokens_[i].unit_mm == 0 && any_of(tokens_, kTap);
    return between != "X" && !pitch;
  }

  // "L=75", "LEN. - 75", "75 LONG".
  bool is_length(std::size_t i) const {
    const bool named = i + 1 < tokens_.size() && is_length_word(tokens_[i + 1]);
    if (named && !number_after(i + 1)) return true;
    for (std::size_t before = i; before-- > 0;)
      if (!is_sign(tokens_[before])) return is_length_word(tokens_[before]);
    return false;
  }

  static bool is_length_word(const Token& token) {
    const auto words = {"L", "LG", "LEN", "LENGTH", "LONG", "LOC", "OAL"};
    return std::ranges::find(words, std::string_view(token.word)) != words.end();
  }

  std::vector<Token> tokens_;
  double unit_mm_;
};

}  // namespace

std::optional<ToolShape> tool_of_words(std::string_view words, double unit_mm) {
  return Description(tool_tokens(words), unit_mm).shape();
}

std::optional<ToolShape> tool_of_exact_words(std::string_view words) {
  for (const char* diameter : {"", "D="}) {
    const std::vector<Token> tokens = tool_tokens(diameter + std::string(words));
    for (std::size_t i = 0; i < tokens.size(); ++i)
      if (!is_understood(tokens, i)) return std::nullopt;
    const Description description(tokens, 1);
    if (const auto shape = description.shape())
      return description.uses_all_numbers(*shape) ? shape : std::nullopt;
  }
  return std::nullopt;
}

bool names_tool(std::string_view words) {
  const std::vector<Token> tokens = tool_tokens(words);
  return is_v_bit(tokens) || std::ranges::any_of(tokens, is_noun);
}

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
