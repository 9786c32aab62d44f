// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "kernel/math/wrench.h"
#include "server/carve/environment_files.h"
#include "server/carve/model_outputs.h"
#include "server/formats/derived_scene.h"
#include "server/formats/mesh_file.h"
#include "server/formats/post.h"

namespace kerf {

/// The command line of kerf-carve.
struct CarveOptions {
  std::filesystem::path scene;  ///< empty: derived from the program
  std::filesystem::path program;
  SceneWishes wishes;                                ///< --stock, --tool, of a derived scene
  std::optional<std::filesystem::path> write_scene;  ///< file for the scene in use
  EnvironmentFiles environment;
  bool verify = false;  ///< judge whether the program makes the part of --reference
  std::optional<std::filesystem::path> reference;  ///< gouges into this mesh are reported
  std::optional<double> gouge_tolerance_mm;        ///< default: the tolerance of the scene
  MeshFile reference_as;  ///< unit, placement and repair of the meshes of --reference and
                          ///< --deviation; no file
  /// Candidates of the search for thin walls; 0: no search; default: by the program (wall_check.h).
  std::optional<std::size_t> wall_samples;
  double tool_change_s = 0;
  std::optional<std::filesystem::path> explain;  ///< only explain this scene
  bool derive = false;                           ///< only print the derived scene
  std::vector<ModelChoice> models;               ///< --stl, --glb, --3mf, --ply, --obj
  SurfaceRequest surface;  ///< --triangles, --max-error, --deviation, --deviation-range
  std::optional<std::filesystem::path> ngc, apt, forces, report;
  std::optional<std::filesystem::path> page;   ///< --report of a verification, as HTML
  Post post = Post::kLinuxcnc;                 ///< of --ngc
  std::optional<WrenchMaximum> device_limits;  ///< adds the felt columns to --forces
  std::optional<double> pitch_mm, tolerance_mm, rate_hz, nc_tolerance_mm;
  std::optional<std::string> rays, motion, law, material;
  int threads;  ///< for carving and for writing files
};

/// Returns the part tolerance of a verification, mm.
inline double part_tolerance_mm(const CarveOptions& options) {
  constexpr double kStandardMm = 0.1;
  return options.tolerance_mm.value_or(kStandardMm);
}

/// Parses the command line. Returns the options, or the exit status if there is nothing more to do:
/// 0 after --help or --version, 2 after an error, which is printed on stderr in one line.
std::variant<CarveOptions, int> parse_carve_options(int argc, char** argv);

/// CLI11 validator of lengths and rates: returns "" for a finite number > 0, otherwise the error.
std::string check_positive(const std::string& text);

}  // namespace kerf
