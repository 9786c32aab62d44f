// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "server/formats/scene.h"
#include "server/formats/scene_fields.h"

namespace kerf {

/// Adds one item of a scene's "tools" to those before it. Throws SceneRejection.
void read_scene_tool(const SceneValue& value, std::map<ToolId, SceneTool>& tools);

}  // namespace kerf
