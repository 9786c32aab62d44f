// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <filesystem>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/sculpture.h"
#include "kernel/tool/tool.h"
#include "server/formats/accuracy_choice.h"
#include "server/formats/gcode/dialect.h"
#include "server/formats/guide.h"
#include "server/formats/mesh_file.h"

namespace kerf {

/// Machine kinematics: conversion of programmed coordinates to tool poses in the workpiece
/// (machine_kinematics.h).
enum class MachineKinematics {
  kXyz,         ///< three linear axes; the tool axis is always +Z
  kXyzacTrt,    ///< tilting table A with a rotary table C on it
  kXyzbcTrt,    ///< tilting table B with a rotary table C on it
  kToolVector,  ///< programs give the tool axis as a vector (I J K)
};
/// Returns the name used in scenes: "xyz", "xyzac-trt", "xyzbc-trt" or "tool-vector".
const char* to_string(MachineKinematics kinematics);

/// One tool of a scene.
struct SceneTool {
  ToolShape shape;  ///< parameters as written in the scene
  ToolBody body;    ///< shank and holder
  Tool tool;        ///< geometry resolved by make_tool
  /// Whether the chord tolerance of the profile, and of the holder's, follows the scene's
  /// tolerance_mm (resolve_chords), because the scene does not state it.
  bool chords_follow = false, holder_chords_follow = false;
  /// In a derived scene: the program names the tool and never moves it, so it does not affect the
  /// accuracy. Not in the canonical text.
  bool idle = false;
  /// In a derived scene: nothing states its diameter. Not in the canonical text.
  bool assumed = false;
};

/// Chord tolerance of profiles without one, as a share of the scene's tolerance_mm. A larger value
/// gives fillets more of the error, and fewer pieces: their number grows as its inverse square
/// root.
inline constexpr double kChordShare = 0.1;

/// The direction in which a positive angle of a rotary axis turns.
enum class RotaryDirection {
  kTable,  ///< the table; relative to the workpiece the tool turns oppositely (LinuxCNC)
  kTool,   ///< the tool relative to the workpiece (ISO 841)
};

/// The machine that executes programs.
struct Machine {
  MachineKinematics kinematics = MachineKinematics::kXyz;
  RotaryDirection rotary_direction = RotaryDirection::kTable;
  /// The tool in the spindle until the first tool change (0: the scene's only one, or an empty
  /// spindle).
  ToolId spindle_tool = 0;
  double rapid_mm_per_min = 10000;  ///< traverse rate of G0 and RAPID, > 0
  /// Limits from which the time on the machine is estimated. All are > 0.
  std::optional<Vec3> feed_max_mm_per_min;        ///< of each linear axis; unset: that of rapids
  Vec3 acceleration_mm_per_s2{3000, 3000, 3000};  ///< of each linear axis
  /// Limits of the tool's axis in the workpiece, which rotary axes turn.
  double turn_max_rad_per_s = 1, turn_acceleration_rad_per_s2 = 10;
  Dialect dialect = Dialect::kAuto;  ///< for programs whose GcodeEnvironment has no dialect
};

/// A validated scene: stock, accuracy, tools, force law, machine and obstacles. Every session and
/// every `kerf-carve` run starts from one.
struct Scene {
  std::string name;
  SculptureSettings settings;         ///< stock, accuracy, force law and obstacles for the kernel
  std::map<ToolId, SceneTool> tools;  ///< at least one; key: T or LOADTL number
  Machine machine;
  /// Set if the scene requested a target; its `accuracy` equals the values in `settings`.
  std::optional<AccuracyChoice> accuracy;
  /// The file of each of settings.obstacles as written in the scene, or "" unless it is a mesh.
  std::vector<MeshFile> obstacle_files;
  std::vector<Guide> guides;  ///< virtual fixtures that haptic devices feel
  /// In a derived scene: the stock is assumed, so its border has no meaning. Not in the canonical
  /// text.
  bool stock_assumed = false;
  MeshFile stock_file;      ///< of a mesh stock as written in the scene; "" otherwise
  MeshRepair stock_repair;  ///< repairs made to it, if the scene requests repair
  std::map<std::string, std::string> files;  ///< name to content, if SceneSource::keep_files
};

/// The reason and the position at which a scene was rejected.
struct SceneError {
  std::string file;
  std::string path;  ///< JSON path, e.g. "tools[0].diameter_mm"; empty for syntax errors
  std::size_t line = 0, column = 0;  ///< from 1; 0 if unknown
  std::string reason;                ///< one clause, e.g. "is 0; it must be above 0"
};
/// Formats an error as one line, e.g.
/// "chips.json:4:25: accuracy.pitch_mm is 0; it must be above 0".
std::string to_string(const SceneError& error);

/// Origin of a scene's text, and the files that it may name.
struct SceneSource {
  std::string name = "scene";  ///< file name for errors
  /// Base folder of file names in the scene; without it only `files` can be named.
  std::optional<std::filesystem::path> base_folder;
  std::map<std::string, std::string> files = {};  ///< name to content; searched before the folder
  bool keep_files = false;                        ///< store the content of every file in the scene
  LoadMesh load_mesh = nullptr;                   ///< without it a scene may name no mesh
  std::stop_token stop = {};                      ///< ends the reading of meshes
};

/// Reads and validates a scene (JSON, at most 1 MiB):
///     auto scene = parse_scene(text, {.name = "chips.json", .base_folder = "scenes"});
///     if (!scene) std::cerr << to_string(scene.error()) << '\n';
/// Errors: invalid JSON, a duplicate, missing or unknown field, a wrong type, a value out of range,
/// a file that cannot be read or is not allowed. If the scene requests a target accuracy, the
/// values that it leaves out are chosen here (accuracy_choice.h).
std::expected<Scene, SceneError> parse_scene(std::string_view text, const SceneSource& source);
/// Reads one tool as in the "tools" of a scene with this tolerance_mm, on which profiles without a
/// chord tolerance depend. An id is ignored. The paths of errors begin at the tool.
std::expected<SceneTool, SceneError> parse_scene_tool(std::string_view text, double tolerance_mm);
/// Reads a scene file. Its folder becomes the base folder.
std::expected<Scene, SceneError> load_scene(const std::filesystem::path& file);

/// Returns the resolved tools.
std::map<ToolId, Tool> tools_of(const Scene& scene);
/// Returns the accuracy in the scene's settings.
Accuracy accuracy_of(const Scene& scene);
/// Chooses the accuracy for a target (choose_accuracy) and stores it in `scene.accuracy` and
/// `scene.settings`. `wall_pitch_mm`: AccuracyUse::wall_pitch_mm. On an error the scene is
/// unchanged.
std::expected<void, AccuracyError> resolve_accuracy(Scene& scene, const AccuracyRequest& request,
                                                    std::optional<double> wall_pitch_mm = {});

/// The reason why a tool of a scene could not be resolved.
struct SceneToolError {
  ToolId tool;
  ToolError error;
};
/// Sets the chord tolerance of the profiles that follow the scene's tolerance_mm to kChordShare of
/// it, and resolves their tools again. parse_scene does so. Call it after changing tolerance_mm.
std::expected<void, SceneToolError> resolve_chords(Scene& scene);

/// Returns the scene as canonical JSON text: every field, in a fixed order ("guides" only if there
/// are any). parse_scene reads it back to an equal scene, given the same files.
std::string scene_json(const Scene& scene);
/// The following return parts of the canonical JSON text, as welcome messages carry them.
/// The "stock" object; for a mesh stock, its bounding box.
std::string stock_json(const Scene& scene);
/// The "tools" array.
std::string tools_json(const Scene& scene);
/// One item of the "tools" array.
std::string tool_json(ToolId id, const SceneTool& tool);
/// The "force" object.
std::string force_json(const Scene& scene);
/// The "accuracy" object; for a chosen accuracy also "target_mm", "predicted_error_mm" and
/// "reason".
std::string accuracy_json(const Scene& scene);

/// Returns a text table with path, value, default, unit and meaning of every field in the scene, as
/// printed by `kerf-carve --explain`.
std::string explain_scene(const Scene& scene);

}  // namespace kerf
