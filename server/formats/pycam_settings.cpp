// SPDX-License-Identifier: Apache-2.0
#include "server/formats/pycam_settings.h"

#include <charconv>
#include <utility>

#include "server/formats/number_text.h"

namespace kerf {
namespace {

constexpr std::string_view kSettings = "PYCAM_TOOLPATH_SETTINGS:";

std::string_view trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t\r");
  if (from == text.npos) return {};
  return text.substr(from, text.find_last_not_of(" \t\r") - from + 1);
}

double number_in(std::string_view text) {
  double value = 0;
  (void)std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// The words for a cutter; empty if it is none of PyCAM's.
std::string words_of(std::string_view shape, double radius, double torus_radius) {
  if (!(radius > 0)) return {};
  const std::string diameter = " D=" + decimal_text(2 * radius, 6);
  if (shape == "CylindricalCutter") return "FLAT END MILL" + diameter;
  if (shape == "SphericalCutter") return "BALL END MILL" + diameter;
  if (shape != "ToroidalCutter" || !(torus_radius > 0)) return {};
  return "BULL NOSE END MILL" + diameter + " CR=" + decimal_text(torus_radius, 6);
}

}  // namespace

bool PycamSettings::read(std::string_view comment) {
  const std::string_view line = trimmed(comment);
  if (line.starts_with(kSettings)) {
    const bool begins = trimmed(line.substr(kSettings.size())) == "START";
    if (const std::string words = words_of(shape_, radius_, torus_radius_);
        inside_ && !begins && !words.empty()) {
      words_ = words;
    }
    inside_ = begins;
    of_tool_ = false;
    shape_.clear();
    radius_ = torus_radius_ = 0;
    return true;
  }
  if (!inside_) return false;
  const std::size_t equals = line.find('=');
  if (line.starts_with('[')) {
    of_tool_ = line == "[Tool]";
  } else if (of_tool_ && equals != line.npos) {
    set(trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)));
  }
  return true;
}

std::optional<std::string> PycamSettings::take_tool() { return std::exchange(words_, {}); }

void PycamSettings::set(std::string_view key, std::string_view value) {
  if (key == "shape") shape_ = value;
  if (key == "tool_radius") radius_ = number_in(value);
  if (key == "torus_radius") torus_radius_ = number_in(value);
}

}  // namespace kerf
