// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/formats/derived_scene.h"

namespace kerf {

/// Returns the origins as a JSON list: `tool` (its number; null: of the scene), `field`, `origin`
/// and `source` of each.
std::string provenance_json(const std::vector<FieldOrigin>& origins);

/// Returns the scene that was derived for a program, as JSON text, in the same bytes to the list of
/// sessions, kerf.html and the command line: `scene`, which parse_scene reads; `provenance`;
/// `notes`; and of the program `motions`, `programmed_s` and `machine_s`. `questions`: the JSON
/// list of questions_json, added if it is not empty.
std::string derived_json(const DerivedScene& derived, const std::string& questions = {});

}  // namespace kerf
