// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/program_facts.h"
#include "server/formats/scene.h"
#include "server/formats/tool_words.h"

namespace kerf {

/// The user's settings for a derived scene. The program determines the rest.
struct SceneWishes {
  std::optional<Vec3> stock_size_mm;
  std::string stock_file;  ///< a mesh (kMeshFileNames) in program coordinates; "" for none
  std::filesystem::path folder = ".";  ///< base of stock_file
  std::map<ToolId, ToolShape> tools;
  std::optional<RotaryDirection> rotary_direction = {};
  /// Bounds of the part that the program should make, if known. An assumed stock is this box, so
  /// that the program need not cut anything around the part.
  std::optional<BoxStock> part_mm = {};
};

/// The origin of a value of a derived scene.
struct FieldOrigin {
  ToolId tool = 0;         ///< the tool of the field; 0: the scene
  std::string field = {};  ///< as in a scene: "diameter_mm"; of a stock "size" and "place"
  Origin origin = Origin::kAssumed;
  std::string source = {};  ///< such as "comment in line 3" and "--tool"
};

/// A scene for a program, and the assumptions made.
struct DerivedScene {
  Scene scene;
  std::vector<std::string> notes;    ///< one line each
  std::vector<FieldOrigin> origins;  ///< for the machine, the stock, the accuracy and every tool
  std::size_t motions = 0;           ///< of the program
  double programmed_s = 0, machine_s = 0;  ///< at feed rate; on a machine (MachineTime)
};

/// Diameter of a tool without a description, mm. The tool is flat.
inline constexpr double kToolAssumedMm = 6;

/// Derives the scene in which a program can be carved. Tools: the wishes, the tool table of
/// `environment` (diameters), the comments of the program (stated_tools.h), else flat tools of
/// kToolAssumedMm. Stock: the wishes, the comments (stated_stock.h), else the box of the cuts
/// (cut_extents.h), wider by the largest tool's radius, to whole mm, 2 mm below the deepest cut. A
/// size is positioned to contain the cuts: with a corner or the center at the origin, else around
/// the cuts; its top at Z 0, or its bottom if Z 0 is the table. Accuracy: the greatest surface
/// error is a thousandth of the stock, between 0.02 and 1 mm. Errors, as one line: those of the
/// program, a program that cuts nothing, a wish for a tool that the program does not name, an
/// unreadable stock file, a requested stop.
std::expected<DerivedScene, std::string> derive_scene(const std::string& name,
                                                      std::string_view program,
                                                      const GcodeEnvironment& environment,
                                                      const SceneWishes& wishes,
                                                      const std::stop_token& stop = {});

}  // namespace kerf
