// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/guide.h"
#include "server/formats/scene_fields.h"

namespace kerf {

/// Returns the paths of a guide's file: the forces file of a stroke, otherwise a program. Throws
/// SceneRejection.
using GuideFile =
    std::function<std::vector<GuidePath>(SceneFields& fields, const PathGuide& guide)>;

/// Reads the "guides" of a scene, or of a welcome, whose guides name no files. Throws
/// SceneRejection. `read_file` may be null. A guide that names a file is then rejected.
std::vector<Guide> read_guides(const SceneValue& list, const GuideFile& read_file);

/// Reads the "guides" of a JSON object, such as a welcome. Returns an empty list if it has no such
/// field. Every snap guide must name its surface. The error is one clause, with the path of the
/// value.
std::expected<std::vector<Guide>, std::string> parse_guides(std::string_view object);

}  // namespace kerf
