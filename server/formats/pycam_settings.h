// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kerf {

/// Reads the settings that PyCAM writes before each toolpath, one in a comment: "[Tool]", "shape =
/// CylindricalCutter", "tool_radius = 1.5", between PYCAM_TOOLPATH_SETTINGS: START and END.
class PycamSettings {
 public:
  /// Reads a comment. Returns whether it is part of the settings.
  bool read(std::string_view comment);
  /// Returns the tool in the words of a tool comment, "FLAT END MILL D=3", once after the end of
  /// its settings. The lengths are in the program's unit.
  std::optional<std::string> take_tool();

 private:
  void set(std::string_view key, std::string_view value);

  bool inside_ = false, of_tool_ = false;
  std::string shape_;
  double radius_ = 0, torus_radius_ = 0;
  std::optional<std::string> words_;
};

}  // namespace kerf
