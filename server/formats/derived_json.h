// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/formats/derived_scene.h"

namespace kerf {

/// Returns the origins as a JSON list with `tool` (its number, or null for the scene), `field`,
/// `origin` and `source` of each.
std::string provenance_json(const std::vector<FieldOrigin>& origins);

/// Returns a derived scene as JSON text, byte for byte the same for the list of sessions, kerf.html
/// and the command line: `scene`, which parse_scene reads, `provenance`, `notes`, and the program's
/// `motions`, `programmed_s` and `machine_s`. `questions`, the JSON list of questions_json, is
/// added if not empty.
std::string derived_json(const DerivedScene& derived, const std::string& questions = {});

}  // namespace kerf
