// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "kernel/tool/tool_shape.h"

namespace kerf {

/// Origin of a value: stated by the program or the user; derived from stated values (a length
/// without a unit is in the program's; a ball's corner follows from its diameter); or assumed.
enum class Origin { kStated, kDerived, kAssumed };

/// Returns "stated", "derived" or "assumed".
const char* to_string(Origin origin);

/// Origins of the fields of a tool. `corner` and `angle` count for shapes that have them.
struct ToolOrigins {
  Origin shape = Origin::kAssumed;
  Origin diameter = Origin::kAssumed;
  Origin corner = Origin::kAssumed;
  Origin angle = Origin::kAssumed;
  bool operator==(const ToolOrigins&) const = default;
};

/// A tool described in words.
struct WordedTool {
  ToolShape shape;
  ToolOrigins origins;
  /// Why the words do not describe this tool, as a clause, or "" if they do. With a doubt all
  /// origins are assumed.
  std::string doubt = {};
  bool names_kind = false;  ///< such as "BALL", not only "TOOL"
  bool names_tool = false;  ///< "TOOL", or a noun such as "MILL", "BIT" and "DRILL"
  bool sized = false;       ///< the size has a unit or a name, such as "6MM" and "D6"
  bool has_length = false;  ///< a length is stated that the shape does not have
};

/// Returns the tool that words describe, as people and post-processors write them in English,
/// German, French and Spanish:
///     D=6. CR=0. - flat end mill          1/4 BALL ENDMILL         #7 DRILL
///     6MM R1 BULL NOSE                    V-BIT 60 DEG 10MM        KUGELFRAESER D6
///     TOOL/MILL,3.18, 0.00, 20.00, 0.0    (Carbide Motion, MeshCAM: diameter and corner radius at
///                                         the tip, height, angle of the side)
/// A length without a unit is in `unit_mm`; a fraction (1/4, 1 1/4) is in inches; a comma between
/// digits is a decimal point. Tools of which only the size is given are flat; a drill without an
/// angle has 118 degrees, an engraver without a size 10 mm. The angle of a chamfer mill is that of
/// its side up to 45 degrees, else that of its tip. The cutting length is five diameters, at least
/// 20 mm. A word that is not understood is a doubt. nullopt: the words state no size or one that is
/// probably in another unit (".5 END MILL" in mm, "D6" in inches), name an operation ("Engraving
/// 1") or contradict themselves.
std::optional<WordedTool> tool_of_words(std::string_view words, double unit_mm);

/// Returns the tool of words that describe one and nothing else, in mm; a size may stand alone:
///     6          6,35 mm ball          1/4 in ball          60 deg v-bit          D=10 CR=1 bull
///     nose
/// nullopt: as of tool_of_words, and where a word, a sign or a number is not understood.
std::optional<ToolShape> tool_of_exact_words(std::string_view words);

/// Returns a drill with the point of most twist drills, or of `tip_deg`.
ToolShape drill_shape(double diameter_mm, double tip_deg = 118);

/// Returns the shape with another cutting length, at least that of its tip.
ToolShape with_cutting_length(ToolShape shape, double length_mm);

}  // namespace kerf
