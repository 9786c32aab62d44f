// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace kerf {

/// Returns the diameter of a number drill (1 to 80), mm, or nullopt for other numbers. Source: ANSI
/// B94.11M, as tables of tap drills print it.
std::optional<double> number_drill_mm(int number);

/// Returns the diameter of a letter drill ("A" to "Z"), mm, or nullopt for other texts.
std::optional<double> letter_drill_mm(std::string_view letter);

/// Returns the major diameter of a numbered machine screw (0 to 12), mm, which is 0.060 in and
/// 0.013 in for each number (ASME B1.1), or nullopt for other numbers.
std::optional<double> screw_mm(int number);

}  // namespace kerf
