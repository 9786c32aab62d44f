// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/carve/model_outputs.h"
#include "server/formats/derived_scene.h"
#include "server/formats/program.h"

namespace kerf {

/// The content of --report.
struct CarveReport {
  std::string scene_file, program_file;
  std::size_t program_lines = 0;
  std::uint64_t motions = 0, sub_motions = 0;
  double machining_s = 0;  ///< sum of the durations of all motions
  double stock_volume_mm3 = 0, removed_volume_mm3 = 0, imprint_volume_mm3 = 0;
  double read_s = 0, cut_s = 0, simulate_s = 0, mesh_s = 0, write_s = 0;
  double total_s = 0;  ///< from the start of the program to this report
  int threads = 1;
  std::optional<std::uint64_t> triangles;  ///< empty if no model was requested
  SurfaceReport surface;
  std::uint64_t state_hash = 0;
  std::size_t stock_memory_bytes = 0;  ///< of the carved block
  std::string simulation = "null";     ///< JSON text (simulation_json.h)
  std::string walls = "null";          ///< JSON text (wall_check.h)
  std::string verdict = "null";        ///< JSON text (verdict.h)
  double walls_s = 0;                  ///< search for thin walls
  std::string read_as;                 ///< language of the program, and why
  std::vector<std::string> warnings;
  std::vector<std::string> notes;    ///< assumptions and choices about the scene
  std::vector<FieldOrigin> origins;  ///< of the fields of a derived scene
};

/// Returns a state hash as in reports: 16 hexadecimal digits.
std::string hash_name(std::uint64_t hash);

/// Returns the report as JSON text, with the peak memory of the process.
std::string report_json(const CarveReport& report, const Scene& scene, const Program& program);

/// Adds a final warning if no stock was removed.
void warn_of_idle_run(CarveReport& report);

}  // namespace kerf
