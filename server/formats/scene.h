// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/sculpture.h"
#include "kernel/tool/tool.h"
#include "server/formats/accuracy_choice.h"

namespace kerf {

/// How programmed coordinates become tool poses in the workpiece (machine_kinematics.h).
enum class MachineKinematics { kXyz, kXyzacTrt, kXyzbcTrt, kToolVector };
/// "xyz", "xyzac-trt", "xyzbc-trt", "tool-vector".
const char* to_string(MachineKinematics kinematics);

struct SceneTool {
  ToolShape shape;  ///< as the user wrote it
  ToolBody body;    ///< its shank and holder
  Tool tool;        ///< resolved by make_tool
};

struct Machine {
  MachineKinematics kinematics = MachineKinematics::kXyz;
  double rapid_mm_per_min = 10000;  ///< speed of G0 and RAPID
};

/// What a session or a carving starts from (design section 8).
struct Scene {
  std::string name;
  SculptureSettings settings;
  std::map<ToolId, SceneTool> tools;  ///< at least one
  Machine machine;
  std::optional<AccuracyChoice> accuracy;  ///< where a target was asked for; stands in settings
  std::vector<std::string>
      obstacle_files;      ///< one per settings.obstacles; empty unless read from an STL file
  std::string stock_file;  ///< of a stock that is a mesh; empty otherwise
  std::map<std::string, std::string> files;  ///< what was read of them, if the source keeps it
};

/// What is wrong with a scene, and where.
struct SceneError {
  std::string file;
  std::string path;  ///< JSON path, e.g. "tools[0].diameter_mm"; empty for syntax errors
  std::size_t line = 0, column = 0;  ///< from 1; 0 where unknown
  std::string reason;                ///< one sentence
};
/// "file:line: path: reason", one line.
std::string to_string(const SceneError& error);

/// Where a scene text comes from.
struct SceneSource {
  std::string name = "scene";  ///< what errors call it
  std::optional<std::filesystem::path>
      base_folder;  ///< file references are relative to it; without it they are rejected
  std::map<std::string, std::string> files = {};  ///< stand instead of files of the base folder
  bool keep_files = false;                        ///< Scene::files gets what was read
};

/// Reads and validates a scene. Unknown fields, wrong types, values out of range and features of
/// later versions are errors.
std::expected<Scene, SceneError> parse_scene(std::string_view text, const SceneSource& source);
/// Reads the file; its folder is the base folder.
std::expected<Scene, SceneError> load_scene(const std::filesystem::path& file);

/// The accuracy that the settings hold.
Accuracy accuracy_of(const Scene& scene);
/// Chooses the accuracy of a scene for a target (accuracy_choice.h) and notes it in the scene and
/// its settings; a scene that cannot be chosen for stays as it was.
std::expected<void, AccuracyError> settle_accuracy(Scene& scene, const AccuracyRequest& request);

/// The whole scene as canonical JSON text (every field, sorted as in design section 8); parse_scene
/// gives it back equal.
std::string scene_json(const Scene& scene);
/// Parts of it as JSON text, as welcome messages carry them: the "stock" object, the "tools" array,
/// the "force" object. Of a stock that is a mesh, the box around it.
std::string stock_json(const Scene& scene);
std::string tools_json(const Scene& scene);
std::string force_json(const Scene& scene);
/// The "accuracy" object as it was resolved: of a chosen one also the target, what is to be
/// expected and why.
std::string accuracy_json(const Scene& scene);

/// A table of every field: path, value, default, unit, meaning. `kerf-carve --explain` prints it.
std::string explain_scene(const Scene& scene);

}  // namespace kerf
