// SPDX-License-Identifier: Apache-2.0
#include "server/formats/scene.h"

#include <algorithm>
#include <utility>

#include "server/formats/number_text.h"

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

Accuracy accuracy_of(const Scene& scene) {
  const SculptureSettings& s = scene.settings;
  return {s.rays, s.pitch_mm, s.tolerance_mm, s.motion};
}

std::expected<void, AccuracyError> resolve_accuracy(Scene& scene, const AccuracyRequest& request,
                                                    std::optional<double> wall_pitch_mm) {
  AccuracyUse use{.stock = scene.settings.stock,
                  .tools = {},
                  .turns = scene.machine.kinematics != MachineKinematics::kXyz,
                  .wall_pitch_mm = wall_pitch_mm};
  for (const auto& [id, tool] : scene.tools)
    if (!tool.idle) use.tools.push_back(tool.tool);
  auto choice = choose_accuracy(request, use);
  if (!choice) return std::unexpected(choice.error());
  const Accuracy& a = choice->accuracy;
  scene.settings.rays = a.rays;
  scene.settings.pitch_mm = a.pitch_mm;
  scene.settings.tolerance_mm = a.tolerance_mm;
  scene.settings.motion = a.motion;
  scene.accuracy = *std::move(choice);
  return {};
}

std::map<ToolId, Tool> tools_of(const Scene& scene) {
  std::map<ToolId, Tool> tools;
  for (const auto& [id, tool] : scene.tools) tools.emplace(id, tool.tool);
  return tools;
}

std::expected<void, SceneToolError> resolve_chords(Scene& scene) {
  const double chord_mm = std::clamp(kChordShare * scene.settings.tolerance_mm,
                                     kChordToleranceMinMm, kChordToleranceMaxMm);
  for (auto& [id, tool] : scene.tools) {
    if (!tool.chords_follow && !tool.holder_chords_follow) continue;
    if (tool.chords_follow) std::get<ProfileShape>(tool.shape).chord_tolerance_mm = chord_mm;
    if (tool.holder_chords_follow)
      std::get<ProfileShape>(*tool.body.holder).chord_tolerance_mm = chord_mm;
    auto made = make_tool(tool.shape, tool.body);
    if (!made) {
      ToolError error = made.error();
      if (error.code == ToolErrorCode::kTooManyPieces)
        error.reason +=
            " (it follows accuracy.tolerance_mm: " + significant_text(chord_mm, 3) + " mm)";
      return std::unexpected(SceneToolError{id, std::move(error)});
    }
    tool.tool = *std::move(made);
  }
  return {};
}

}  // namespace kerf
