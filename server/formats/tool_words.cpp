// SPDX-License-Identifier: Apache-2.0
#include "server/formats/tool_words.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "server/formats/letter_case.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr double kDrillDeg = 118, kSpotDeg = 90, kEngraverDeg = 60, kEngraverMm = 10;
constexpr double kLengthDiameters = 5, kLengthMinMm = 20;
/// Greatest diameter that is believed, mm: face mills and fly cutters.
constexpr double kDiameterMaxMm = 500;

// A word of letters, a number with its unit, or a sign.
struct Token {
  std::string word;  ///< upper case; empty for a number
  double value = 0;
  double unit_mm = 0;  ///< 0: none is written
  bool degrees = false;
  bool is_number() const { return word.empty(); }
};

bool is_letter(char c) {
  const char low = to_lower(c);
  return (low >= 'a' && low <= 'z') || static_cast<unsigned char>(c) >= 0x80;
}

class Tokens {
 public:
  explicit Tokens(std::string_view text) : text_(text) {
    while (at_ < text_.size()) next();
  }
  std::vector<Token> take() { return std::move(tokens_); }

 private:
  char at(std::size_t i) const { return i < text_.size() ? text_[i] : '\0'; }

  void next() {
    const char c = at(at_);
    if (is_letter(c)) return word();
    if (is_digit(c) || (c == '.' && is_digit(at(at_ + 1)))) return number();
    if (c != ' ' && c != '\t') tokens_.push_back({std::string(1, c)});
    ++at_;
  }

  void word() {
    const std::size_t from = at_;
    while (is_letter(at(at_))) ++at_;
    tokens_.push_back({to_upper(std::string(text_.substr(from, at_ - from)))});
  }

  double digits() {
    const std::size_t from = at_;
    while (is_digit(at(at_))) ++at_;
    if (at(at_) == '.') ++at_;
    while (is_digit(at(at_))) ++at_;
    return std::strtod(std::string(text_.substr(from, at_ - from)).c_str(), nullptr);
  }

  // 6, 6.35, .25, 1/4 and 1-1/4, each with its unit.
  void number() {
    Token token;
    token.value = digits();
    if (at(at_) == '/' && is_digit(at(at_ + 1))) {
      ++at_;
      const double divisor = digits();
      token.value = divisor > 0 ? token.value / divisor : 0;
      token.unit_mm = kMmPerInch;
      const std::size_t n = tokens_.size();
      if (n >= 2 && tokens_[n - 1].word == "-" && tokens_[n - 2].is_number()) {
        token.value += tokens_[n - 2].value;
        tokens_.resize(n - 2);
      }
    }
    unit(token);
    tokens_.push_back(token);
  }

  void unit(Token& token) {
    std::size_t from = at_;
    while (at(from) == ' ') ++from;
    if (at(from) == '"' || (at(from) == '\'' && at(from + 1) == '\'')) {
      token.unit_mm = kMmPerInch;
      at_ = from + (at(from) == '"' ? 1 : 2);
      return;
    }
    std::size_t end = from;
    while (is_letter(at(end))) ++end;
    const std::string word = to_upper(std::string(text_.substr(from, end - from)));
    token.degrees = word == "DEG" || word == "DEGREE" || word == "DEGREES" || word == "\xC2\xB0";
    const bool mm = word == "MM" || word == "MILLIMETERS";
    const bool inch = word == "IN" || word == "INCH" || word == "INCHES";
    if (mm || inch) token.unit_mm = mm ? 1 : kMmPerInch;
    if (mm || inch || token.degrees) at_ = end;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<Token> tokens_;
};

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

class Description {
 public:
  Description(std::vector<Token> tokens, double unit_mm)
      : tokens_(std::move(tokens)), unit_mm_(unit_mm) {}

  std::optional<ToolShape> shape() {
    if (const auto carbide = of_carbide()) return carbide;
    const bool engraves = is_v_bit(tokens_);
    const auto diameter = engraves && !diameter_mm() ? std::optional(kEngraverMm) : diameter_mm();
    if (!diameter || !(*diameter > 0) || *diameter > kDiameterMaxMm) return std::nullopt;
    if (engraves && !any_of(tokens_, kEngraver) && !angle_deg()) return std::nullopt;
    return of(*diameter, engraves);
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

  // The number behind a word and signs such as "=", ":" and "-".
  const Token* number_after(std::size_t i) const {
    for (++i; i < tokens_.size(); ++i) {
      if (tokens_[i].is_number()) return &tokens_[i];
      if (tokens_[i].word.size() != 1 ||
          std::string_view("=:.-+").find(tokens_[i].word) == std::string_view::npos)
        return nullptr;
    }
    return nullptr;
  }

  std::optional<double> after(std::initializer_list<std::string_view> keys, bool plain) const {
    for (std::size_t i = 0; i < tokens_.size(); ++i) {
      if (std::ranges::find(keys, std::string_view(tokens_[i].word)) == keys.end()) continue;
      if (const Token* number = number_after(i)) return plain ? number->value : mm(*number);
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
        if (const Token* number = number_after(i)) return mm(*number);
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

  bool is_size(std::size_t i) const { return tokens_[i].is_number() && !tokens_[i].degrees; }

  std::vector<Token> tokens_;
  double unit_mm_;
};

}  // namespace

std::optional<ToolShape> tool_of_words(std::string_view words, double unit_mm) {
  return Description(Tokens(words).take(), unit_mm).shape();
}

bool names_tool(std::string_view words) {
  const std::vector<Token> tokens = Tokens(words).take();
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
