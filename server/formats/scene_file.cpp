// SPDX-License-Identifier: Apache-2.0
#include "server/formats/scene.h"
#include "server/formats/text_file.h"

namespace kerf {

std::expected<Scene, SceneError> load_scene(const std::filesystem::path& path) {
  const SceneSource source{
      .name = path.string(), .base_folder = path.parent_path(), .load_mesh = load_mesh};
  const auto text = read_file(path);
  if (!text)
    return std::unexpected(SceneError{.file = source.name, .path = {}, .reason = "cannot be read"});
  return parse_scene(*text, source);
}

}  // namespace kerf
