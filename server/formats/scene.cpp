#include "server/formats/scene.h"

#include "server/formats/text_file.h"

namespace kerf {

const char* to_string(MachineKinematics kinematics) {
  switch (kinematics) {
    case MachineKinematics::kXyz:
      return "xyz";
    case MachineKinematics::kXyzacTrt:
      return "xyzac-trt";
    case MachineKinematics::kXyzbcTrt:
      return "xyzbc-trt";
    case MachineKinematics::kToolVector:
      return "tool-vector";
  }
  return "";
}

std::string to_string(const SceneError& error) {
  std::string text = error.file + ":";
  if (error.line > 0) text += std::to_string(error.line) + ":" + std::to_string(error.column) + ":";
  if (!error.path.empty()) text += " " + error.path;
  return text + " " + error.reason;
}

std::expected<Scene, SceneError> load_scene(const std::filesystem::path& path) {
  const SceneSource source{.name = path.string(), .base_folder = path.parent_path()};
  const auto text = read_file(path);
  if (!text)
    return std::unexpected(SceneError{.file = source.name, .path = {}, .reason = "cannot be read"});
  return parse_scene(*text, source);
}

}  // namespace kerf
