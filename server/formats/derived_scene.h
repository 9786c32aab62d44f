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

/// What the user states of a scene that is derived; the rest is taken from the program.
struct SceneWishes {
  std::optional<Vec3> stock_size_mm;
  std::string stock_file;  ///< a mesh (kMeshFileNames) in program coordinates; "" for none
  std::filesystem::path folder = ".";  ///< that stock_file is relative to
  std::map<ToolId, ToolShape> tools;
  std::optional<RotaryDirection> rotary_direction = {};
  /// Bounds of the part that the program is to make, if it is known: an assumed stock is their box,
  /// so that it leaves nothing around the part that the program need not cut.
  std::optional<BoxStock> part_mm = {};
};

/// The origin of a value of a derived scene.
struct FieldOrigin {
  ToolId tool = 0;         ///< of which it is a field; 0: of the scene
  std::string field = {};  ///< as in a scene: "diameter_mm"; of a stock "size" and "place"
  Origin origin = Origin::kAssumed;
  std::string source = {};  ///< such as "comment in line 3" and "--tool"
};

/// A scene for a program, and what was assumed.
struct DerivedScene {
  Scene scene;
  std::vector<std::string> notes;    ///< one line each
  std::vector<FieldOrigin> origins;  ///< of the machine, the stock, the accuracy and every tool
  std::size_t motions = 0;           ///< of the program
  double programmed_s = 0, machine_s = 0;  ///< at feed rate; on a machine (MachineTime)
};

/// Diameter of a tool that nothing describes, mm; it is flat.
inline constexpr double kToolAssumedMm = 6;

/// Derives the scene in which a program can be carved. Tools: the wishes, the tool table of
/// `environment` (diameters), the comments of the program (stated_tools.h), else flat tools of
/// kToolAssumedMm. Stock: the wishes, the comments (stated_stock.h), else the box of the cuts
/// (cut_extents.h), wider by the largest tool's radius, to whole mm, 2 mm below the deepest cut. A
/// size is placed where the cuts lie in it: with a corner or the center at the origin, else around
/// the cuts; its top at Z 0, or its bottom if the program counts from the table. Accuracy: the
/// greatest surface error is a thousandth of the stock, between 0.02 and 1 mm. Errors, as one line:
/// those of the program, a program that cuts nothing, a wish for a tool that the program does not
/// name, a stock file that cannot be read, a stop that was requested.
std::expected<DerivedScene, std::string> derive_scene(const std::string& name,
                                                      std::string_view program,
                                                      const GcodeEnvironment& environment,
                                                      const SceneWishes& wishes,
                                                      const std::stop_token& stop = {});

}  // namespace kerf
