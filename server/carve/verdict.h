// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/carve/part_fit.h"
#include "server/carve/simulation.h"

namespace kerf {

/// A reason why a program fails its verification.
struct Finding {
  std::string what;                  ///< with its amount: "0.500 mm too deep"
  std::string place;                 ///< "part.nc:12"; empty if no line is its cause
  std::uint32_t file = 0, line = 0;  ///< of its position (ProgramMotion)
  ToolId tool = 0;                   ///< 0 without one
  std::optional<Vec3> at_mm;
};

/// One of the questions that a verification answers.
struct Check {
  const char* name;
  std::size_t count = 0;       ///< of findings; 0: passed
  bool of_shape = false;       ///< whether the part is wrong, not only the process
  std::vector<Finding> worst;  ///< worst first; collisions and rapids in the order of the program
};

/// The answer to "does this program make that part".
struct Verdict {
  std::string program, part;  ///< names
  double tolerance_mm = 0;
  double cycle_s = 0;
  double loose_mm3 = 0;  ///< of pieces that were cut loose
  bool cuts_nothing = false;
  /// Assumptions of a derived scene on which the answer depends: "the stock", "tool 2".
  std::vector<std::string> assumed = {};
  std::vector<Check> checks;

  bool makes_part() const;
  /// Returns whether it makes the part, without a collision and without a rapid through stock.
  bool passes() const;
};

/// Listed findings of a check.
inline constexpr std::size_t kFindingsMax = 50;

/// `scene` and `simulation`: as carved. `fit` must be two-sided.
Verdict make_verdict(const Scene& scene, const Simulation& simulation, const PartFit& fit,
                     std::string part, double tolerance_mm, double tool_change_s);

/// Adds a warning if the pitch exceeds the tolerance of the part, so that deviations of upright
/// walls may fall between the rays.
void warn_of_resolution(const Scene& scene, double tolerance_mm,
                        std::vector<std::string>& warnings);

/// Returns the answer in one line, without its end.
std::string answer_of(const Verdict& verdict);
/// Returns the answer and a short table, as kerf-carve --verify prints them.
std::string verdict_text(const Verdict& verdict);
/// Returns the "verdict" object of the report as JSON text.
std::string verdict_json(const Verdict& verdict);
/// Returns h:mm:ss.
std::string clock_text(double seconds);

}  // namespace kerf
