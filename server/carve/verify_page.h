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

/// Content of the page of a verification.
struct VerifyPage {
  const Verdict& verdict;
  const Simulation& simulation;
  const Scene& scene;
  const CarveReport& report;
  std::string_view program_text;
  std::vector<FitPicture> pictures;
};

/// Returns the report of a verification as one HTML file, also well-formed XML, that loads nothing:
/// answer, checks, pictures, load along the program, the worst positions with their lines,
/// assumptions, settings and versions. Texts of a program and file names are escaped.
std::string verify_page(const VerifyPage& page);

}  // namespace kerf
