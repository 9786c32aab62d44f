// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "server/carve/environment_files.h"
#include "server/carve/model_outputs.h"

namespace kerf {

/// What the command line of kerf-carve asks for (design section 8).
struct CarveOptions {
  std::filesystem::path scene, program;
  EnvironmentFiles environment;
  std::optional<std::filesystem::path> reference;  ///< gouges into this mesh are reported
  std::optional<double> gouge_tolerance_mm;        ///< otherwise the scene's tolerance
  double tool_change_s = 0;
  std::optional<std::filesystem::path> explain;  ///< explain this scene and do nothing else
  std::vector<ModelChoice> models;               ///< --stl, --glb, --3mf, --ply, --obj
  SurfaceRequest surface;  ///< --triangles, --max-error, --deviation, --deviation-range
  std::optional<std::filesystem::path> ngc, apt, forces, report;
  std::optional<double> pitch_mm, tolerance_mm, rate_hz, nc_tolerance_mm;
  std::optional<std::string> rays, motion, law;
  int threads;  ///< that carve, and that write files
};

/// The options, or the exit status where the command line has been answered already (--help,
/// --version: 0; a mistake, with one line on stderr: 2).
std::variant<CarveOptions, int> parse_carve_options(int argc, char** argv);

}  // namespace kerf
