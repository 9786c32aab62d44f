// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "server/formats/scene.h"
#include "server/formats/scene_fields.h"

namespace kerf {

/// Reads one item of a scene's "tools" and adds it to `tools`. Throws SceneRejection, also for an
/// id that `tools` already contains.
void read_scene_tool(const SceneValue& value, std::map<ToolId, SceneTool>& tools);
/// Reads a tool that may have an id, which is ignored. Throws SceneRejection.
SceneTool read_scene_tool(const SceneValue& value);

}  // namespace kerf
