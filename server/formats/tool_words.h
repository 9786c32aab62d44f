// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "kernel/tool/tool_shape.h"

namespace kerf {

/// Returns the tool that words describe, as people and post-processors write them:
///     D=6. CR=0. - flat end mill          1/4 BALL ENDMILL         DIA-0.500 DRILL
///     12MM 3 FLUTE SQUARE                 V-BIT 60 DEG 10MM        TOOL/MILL,3.18, 0.00, 20.00,
///     0.0
/// A length without a unit is in `unit_mm`; a fraction (1/4, 1 1/4) is in inches; a comma between
/// digits is a decimal point. Tools of which only the size
/// is given are flat; a drill without an angle has 118 degrees, an engraver without a size 10 mm.
/// The cutting length is five diameters, at least 20 mm. nullopt: the words state no size.
std::optional<ToolShape> tool_of_words(std::string_view words, double unit_mm);

/// Returns the tool of words that describe one and nothing else, in mm; a size may stand alone:
///     6          6,35 mm ball          1/4 in ball          60 deg v-bit          D=10 CR=1 bull
///     nose
/// nullopt: as of tool_of_words, and where a word, a sign or a number is not understood.
std::optional<ToolShape> tool_of_exact_words(std::string_view words);

/// Whether words name a kind of tool: "END MILL", "Bohrer".
bool names_tool(std::string_view words);

/// Returns the shape with another cutting length, at least that of its tip.
ToolShape with_cutting_length(ToolShape shape, double length_mm);

}  // namespace kerf
