// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/dexel/stock_shape.h"
#include "server/formats/scene.h"

namespace kerf {

/// An answer to the question about the unit of a mesh, and the mesh's greatest side with it, mm.
struct UnitChoice {
  std::string unit;  ///< "cm", "inch", "m"; "" where the numbers are too large for any unit
  double scale = 1;  ///< "placement.scale" instead
  double size_mm = 0;
};

/// A question about a mesh without a stated unit, whose size in mm is doubtful.
struct UnitQuestion {
  std::string field;  ///< what answers it, such as "stock.placement.unit"
  std::string text;   ///< one line that states the sizes and the answers
  std::vector<UnitChoice> choices;
};

/// Returns the question for a mesh whose greatest side is `size_mm`: below 1 mm or above 10 m, or
/// at least 300 times as large, or as small, as its `partner_mm` (the stock). `name`: its file.
/// Empty for a plausible size.
std::optional<UnitQuestion> unit_question(std::string_view field, std::string_view name,
                                          double size_mm, std::optional<double> partner_mm = {});
/// The same for a mesh file whose format may state the unit, and for which a unit or a scale may be
/// given.
std::optional<UnitQuestion> unit_question(std::string_view field, const MeshFile& file,
                                          const BoxStock& bounds,
                                          std::optional<double> partner_mm = {});

/// The questions of a scene: about its stock, then about its obstacles, compared with the stock.
std::vector<UnitQuestion> unit_questions(const Scene& scene);

/// The greatest side of a box, mm.
double greatest_side_mm(const BoxStock& box);
/// As JSON: a list of {field, text, choices: [{unit | scale, size_mm}]}.
std::string questions_json(const std::vector<UnitQuestion>& questions);

}  // namespace kerf
