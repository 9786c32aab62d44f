// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/guide.h"

namespace kerf {

struct Scene;

/// Reads a program, as parse_program does, and returns the paths of its cutting motions, joined
/// within `join_mm` > 0: one path from each rapid motion, jump or tool change to the next. The
/// error is one clause.
std::expected<std::vector<GuidePath>, std::string> paths_of_program(const std::string& name,
                                                                    std::string_view text,
                                                                    const Scene& scene,
                                                                    double join_mm);

/// Reads the strokes of a forces file (forces_csv.h): one path from each touch of the stock to the
/// next lift, with the computed wrench of each row. Rows less than `apart_mm` after the last kept
/// row are omitted, except at the ends. The error is one clause.
std::expected<std::vector<GuidePath>, std::string> strokes_of_forces(std::string_view text,
                                                                     double apart_mm);

}  // namespace kerf
