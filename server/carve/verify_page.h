// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/carve/carve_report.h"
#include "server/carve/fit_pictures.h"
#include "server/carve/simulation.h"
#include "server/carve/verdict.h"
#include "server/formats/scene.h"

namespace kerf {

/// What the page of a verification shows.
struct VerifyPage {
  const Verdict& verdict;
  const Simulation& simulation;
  const Scene& scene;
  const CarveReport& report;
  std::string_view program_text;
  std::vector<FitPicture> pictures;
};

/// Returns the report of a verification as one HTML file, well-formed as XML too, that loads
/// nothing: answer, checks, pictures, load along the program, the worst places with their lines,
/// assumptions, settings and versions. Any text of a program or a file name is only text in it.
std::string verify_page(const VerifyPage& page);

}  // namespace kerf
