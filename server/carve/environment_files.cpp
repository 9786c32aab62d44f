// SPDX-License-Identifier: Apache-2.0
#include "server/carve/environment_files.h"

#include "server/formats/gcode/parameter_file.h"
#include "server/formats/text_file.h"
#include "server/formats/units.h"

namespace kerf {

std::expected<GcodeEnvironment, std::string> load_environment(
    const EnvironmentFiles& files, const std::filesystem::path& program) {
  GcodeEnvironment environment;
  environment.dialect = files.dialect;
  if (files.inch_machine) environment.machine_unit_mm = kMmPerInch;
  environment.subroutine_folders = {program.has_parent_path() ? program.parent_path() : "."};
  for (const std::filesystem::path& folder : files.subroutine_folders) {
    if (!std::filesystem::is_directory(folder))
      return std::unexpected(folder.string() + ": is not a folder");
    environment.subroutine_folders.push_back(folder);
  }
  if (files.tool_table) {
    const std::string name = files.tool_table->string();
    const auto text = read_file(*files.tool_table);
    if (!text) return std::unexpected(name + ": cannot be read");
    auto table = read_tool_table(name, *text, environment.machine_unit_mm);
    if (!table) return std::unexpected(to_string(table.error()));
    environment.tools = *std::move(table);
  }
  if (files.parameters) {
    const std::string name = files.parameters->string();
    const auto text = read_file(*files.parameters);
    if (!text) return std::unexpected(name + ": cannot be read");
    auto parameters = read_parameter_file(name, *text);
    if (!parameters) return std::unexpected(to_string(parameters.error()));
    environment.parameters = *std::move(parameters);
  }
  return environment;
}

}  // namespace kerf
