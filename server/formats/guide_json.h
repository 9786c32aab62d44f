// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/formats/guide.h"

namespace kerf {

/// Form of guide paths that were read from files.
enum class GuideFiles {
  kNamed,     ///< as the name of the file, as in the canonical text of a scene
  kExpanded,  ///< as poses, as in welcome messages
};

/// Returns guides as the JSON list of a scene's "guides". read_guides reads equal ones back.
std::string guides_json(const std::vector<Guide>& guides, GuideFiles files);

}  // namespace kerf
