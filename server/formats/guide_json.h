// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/formats/guide.h"

namespace kerf {

/// How the paths of guides that were read from files are written.
enum class GuideFiles {
  kNamed,     ///< as the name of the file, as in the canonical text of a scene
  kExpanded,  ///< as poses, as in welcome messages
};

/// Returns guides as the JSON list of a scene's "guides"; read_guides reads it back to equal ones.
std::string guides_json(const std::vector<Guide>& guides, GuideFiles files);

}  // namespace kerf
