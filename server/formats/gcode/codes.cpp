// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/codes.h"

#include <array>
#include <span>
#include <string_view>

#include "server/formats/gcode/fault.h"

namespace kerf {
namespace {

// Codes from `first` to `last` with their group. If `rejection` is set, they are not supported for
// that reason.
struct Codes {
  int first, last;
  GcodeGroup group;
  std::string_view rejection = {};
};

constexpr std::string_view kTurning =
    "is a lathe code; turning, where the workpiece rotates, is not supported";
constexpr std::string_view kProbing =
    "is a probing move, which is not supported: the contact point is known on a machine only";
constexpr std::string_view kSpline = "is a NURBS, which is not supported; use G5, G5.1 or lines";
constexpr std::string_view kUvwPlane = "selects a plane of the axes U V W, which are not supported";

using enum GcodeGroup;

constexpr std::array kGCodes{
    Codes{0, 0, kMotion},
    Codes{10, 10, kMotion},
    Codes{20, 20, kMotion},
    Codes{30, 30, kMotion},
    Codes{40, 40, kNonModal},
    Codes{50, 51, kMotion},
    Codes{52, 53, kMotion, kSpline},
    Codes{70, 70, kDiameter, kTurning},
    Codes{80, 80, kDiameter},
    Codes{100, 100, kNonModal},
    Codes{170, 170, kPlane},
    Codes{171, 171, kPlane, kUvwPlane},
    Codes{180, 180, kPlane},
    Codes{181, 181, kPlane, kUvwPlane},
    Codes{190, 190, kPlane},
    Codes{191, 191, kPlane, kUvwPlane},
    Codes{200, 200, kUnits},
    Codes{210, 210, kUnits},
    Codes{280, 281, kNonModal},
    Codes{300, 301, kNonModal},
    Codes{330, 330, kMotion,
          "is spindle-synchronized threading, which is not supported: the spindle angle is not "
          "modeled"},
    Codes{331, 331, kMotion},
    Codes{382, 385, kMotion, kProbing},
    Codes{400, 400, kCutterCompensation},
    Codes{410, 411, kCutterCompensation},
    Codes{420, 421, kCutterCompensation},
    Codes{430, 432, kToolLength},
    Codes{434, 434, kToolLength},
    Codes{490, 490, kToolLength},
    Codes{520, 520, kNonModal},
    Codes{530, 530, kNonModal},
    Codes{540, 540, kCoordinateSystem},
    Codes{550, 550, kCoordinateSystem},
    Codes{560, 560, kCoordinateSystem},
    Codes{570, 570, kCoordinateSystem},
    Codes{580, 580, kCoordinateSystem},
    Codes{590, 593, kCoordinateSystem},
    Codes{610, 611, kPathControl},
    Codes{640, 640, kPathControl},
    Codes{700, 722, kMotion, kTurning},
    Codes{730, 730, kMotion},
    Codes{740, 740, kMotion},
    Codes{760, 760, kMotion, kTurning},
    Codes{800, 800, kMotion},
    Codes{810, 810, kMotion},
    Codes{820, 820, kMotion},
    Codes{830, 830, kMotion},
    Codes{840, 840, kMotion},
    Codes{850, 850, kMotion},
    Codes{860, 860, kMotion},
    Codes{870, 870, kMotion},
    Codes{880, 880, kMotion},
    Codes{890, 890, kMotion},
    Codes{900, 900, kDistance},
    Codes{901, 901, kArcDistance},
    Codes{910, 910, kDistance},
    Codes{911, 911, kArcDistance},
    Codes{920, 920, kNonModal},
    Codes{921, 923, kShiftApplied},
    Codes{930, 930, kFeedMode},
    Codes{940, 940, kFeedMode},
    Codes{950, 950, kFeedMode},
    Codes{960, 960, kSpindleMode},
    Codes{970, 970, kSpindleMode},
    Codes{980, 980, kRetract},
    Codes{990, 990, kRetract},
};

constexpr std::array kMCodes{
    Codes{0, 2, kStop},
    Codes{3, 5, kSpindle},
    Codes{6, 6, kToolChange},
    Codes{7, 9, kCoolant},
    Codes{19, 19, kSpindle},
    Codes{30, 30, kStop},
    Codes{48, 53, kOverride},
    Codes{60, 60, kStop},
    Codes{61, 61, kToolChange},
    Codes{62, 68, kInputOutput},
    Codes{70, 73, kSpindle},
    Codes{99, 99, kStop},
    Codes{100, 199, kStop,
          "is a user-defined M code, which is not supported: it runs a program of the machine"},
    Codes{428, 429, kTcp},
};

const Codes* find(std::span<const Codes> known, int code) {
  for (const Codes& codes : known)
    if (code >= codes.first && code <= codes.last) return &codes;
  return nullptr;
}

}  // namespace

GcodeGroup gcode_group(char letter, int code, const std::string& text) {
  const Codes* known = letter == 'g' ? find(kGCodes, code) : find(kMCodes, code);
  if (known == nullptr) throw GcodeFault{text, "is not a supported code"};
  if (!known->rejection.empty()) throw GcodeFault{text, std::string(known->rejection)};
  return known->group;
}

bool takes_axis_words(int code) {
  return code == 100 || code == 280 || code == 300 || code == 520 || code == 920;
}

bool is_canned_cycle(int code) {
  return code == 730 || code == 740 || (code >= 810 && code <= 890);
}

}  // namespace kerf
