// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/codes.h"

#include <array>
#include <span>
#include <string_view>

#include "server/formats/control/fault.h"

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

constexpr std::string_view kMeasures = "measures on the machine, which is not supported";
constexpr std::string_view kTilted =
    "tilts the working plane, which is not supported; post without tilted planes";

// Codes of Fanuc and Haas that differ from LinuxCNC's.
constexpr std::array kMacroGCodes{
    Codes{21, 22, kMotion, "is an involute, which is not supported"},
    Codes{50, 50, kNoEffect},  // high-speed machining
    Codes{51, 51, kNoEffect},  // look-ahead, smoothing
    Codes{61, 62, kMotion, kSpline},
    Codes{71, 71, kMotion, "is cylindrical interpolation, which is not supported"},
    Codes{80, 80, kNoEffect},
    Codes{90, 90, kNoEffect},
    Codes{101, 109, kNonModal, "writes data of the machine, which is not supported"},
    Codes{110, 110, kNoEffect},
    Codes{120, 130, kMotion},  // of Haas and Mach3 only
    Codes{150, 150, kPolar},
    Codes{160, 160, kPolar},
    Codes{220, 230, kNoEffect},  // stored stroke limits
    Codes{290, 290, kNonModal, "returns from the reference point, which is not supported"},
    Codes{310, 310, kMotion, kProbing},
    Codes{330, 331, kMotion, "is thread cutting, which is not supported"},
    Codes{350, 370, kNonModal, kMeasures},
    Codes{401, 401, kNoEffect},  // normal-direction control off
    Codes{435, 435, kToolLength},
    Codes{440, 440, kToolLength, "is a negative length offset, which is not supported; use G43"},
    Codes{450, 480, kNonModal, "changes the length of motions, which is not supported"},
    Codes{500, 500, kScaling},
    Codes{510, 510, kScaling},
    Codes{501, 501, kMirror},
    Codes{511, 511, kMirror},
    Codes{531, 531, kNonModal, kTilted},
    Codes{541, 541, kMoreSystems},
    Codes{600, 600, kNoEffect},  // single-direction positioning: the end is the same
    Codes{610, 630, kPathControl},
    Codes{650, 660, kNonModal, "must be the first code of its block"},
    Codes{670, 670, kNoEffect},
    Codes{680, 680, kRotation},
    Codes{682, 684, kRotation, kTilted},
    Codes{690, 690, kRotation},
    Codes{700, 710, kUnits},
    Codes{720, 720, kUnits},   // as G70 and G71, holes of a Haas
    Codes{760, 760, kMotion},  // fine boring, without the shift at the bottom
    Codes{770, 770, kMotion, "is back boring, which is not supported"},
    Codes{870, 870, kMotion, "is back boring, which is not supported"},
    Codes{1000, 1000, kMirror},
    Codes{1010, 1010, kMirror},
    Codes{1020, 1030, kNoEffect},
    Codes{1100, 1290, kMoreSystems},
    Codes{1360, 1360, kNonModal, kMeasures},
    Codes{1410, 1430, kToolLength, "is five-axis compensation, which is not supported; use G43.4"},
    Codes{1500, 1500, kMotion},  // of Haas only
    Codes{1540, 1540, kMoreSystems},
    Codes{1870, 1870, kNoEffect},
    Codes{2340, 2340, kToolLength},
    Codes{2540, 2550, kRotation, kTilted},
};

constexpr std::array kMacroMCodes{
    Codes{97, 99, kJump},
    Codes{16, 16, kToolChange},
};

const Codes* find(std::span<const Codes> known, int code) {
  for (const Codes& codes : known)
    if (code >= codes.first && code <= codes.last) return &codes;
  return nullptr;
}

// M codes with the same meaning on all milling machines. Machine builders define the rest.
bool is_common_m(int code) {
  return code <= 9 || code == 16 || code == 19 || code == 30 || code == 60;
}

}  // namespace

GcodeGroup gcode_group(char letter, int code, const std::string& text, const DialectRules& rules) {
  const Codes* known = nullptr;
  if (rules.macros) known = letter == 'g' ? find(kMacroGCodes, code) : find(kMacroMCodes, code);
  if (known == nullptr) known = letter == 'g' ? find(kGCodes, code) : find(kMCodes, code);
  if (rules.macros && letter == 'm' && (known == nullptr || !is_common_m(code)))
    return known != nullptr && known->group == kJump ? kJump : kUnknown;
  const bool is_haas = rules.dialect == Dialect::kHaas;
  const bool is_circle = letter == 'g' && (code == 120 || code == 130);
  const bool is_foreign = (is_circle && !is_haas && rules.dialect != Dialect::kMach3) ||
                          (letter == 'g' && code == 1500 && !is_haas);
  if (known == nullptr || is_foreign) throw ProgramFault{text, "is not a supported code"};
  if (!known->rejection.empty()) throw ProgramFault{text, std::string(known->rejection)};
  return known->group;
}

bool takes_axis_words(int code) {
  return code == 100 || code == 280 || code == 300 || code == 520 || code == 920;
}

bool is_canned_cycle(int code) {
  return code == 730 || code == 740 || code == 760 || (code >= 810 && code <= 890);
}

}  // namespace kerf
