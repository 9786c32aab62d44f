// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/carve/carve_options.h"
#include "server/carve/failure.h"
#include "server/formats/derived_scene.h"
#include "server/formats/scene.h"

namespace kerf {

/// A scene, with assumptions and choices made for it.
struct ChosenScene {
  Scene scene;
  std::vector<std::string> notes;
  std::vector<FieldOrigin> origins;  ///< of the fields of a derived scene
};

/// Returns the derived scene of the options' program, as a line of JSON (derived_json.h).
std::expected<std::string, Failure> derived_text(const CarveOptions& options);
/// Returns every field of the scene in a file, for people (explain_scene).
std::expected<std::string, Failure> explained_text(const std::filesystem::path& file);

/// Returns the scene to carve: that of --scene or one derived from the program, with the accuracy
/// and the force law of the command line. `part_mm`: bounds of the part, for a verification
/// (SceneWishes::part_mm).
std::expected<ChosenScene, Failure> choose_scene(const CarveOptions& options,
                                                 const std::optional<BoxStock>& part_mm);

/// Returns the text of a scene of choose_scene for the file `target`. Files named relative to the
/// scene's own folder (that of --scene, or the current one) are renamed relative to target's.
std::string scene_text(Scene scene, const CarveOptions& options,
                       const std::filesystem::path& target);

/// Names the scene in errors: its file, or the program from which it was derived.
std::string scene_label(const CarveOptions& options);

}  // namespace kerf
