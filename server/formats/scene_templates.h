// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace kerf {

/// A scene to start from.
struct SceneTemplate {
  std::string_view id, title, description;
  std::string_view scene;  ///< JSON for parse_scene; it names no file
};

/// The scenes that servers offer for new sessions.
std::span<const SceneTemplate> scene_templates();

}  // namespace kerf
