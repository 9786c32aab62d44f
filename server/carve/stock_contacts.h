// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/formats/program.h"

namespace kerf {

/// Most warnings of one kind. Reports list all cases.
inline constexpr std::size_t kWarningsMax = 20;

/// Consecutive motions of one tool with an unwanted contact.
struct ContactRun {
  ToolId tool = 0;
  std::uint32_t from_file = 0, from_line = 0, to_file = 0, to_line = 0;
  double worst = 0;    ///< depth, mm, or force, N
  Vec3 tip_mm;         ///< at the end of the motion with the greatest amount
  bool rapid = false;  ///< one of the motions was a rapid
};

/// Collects contacts: one entry per run of motions.
class ContactRuns {
 public:
  /// Adds the next motion of the program and its amount (0 without contact).
  void follow(const ProgramMotion& motion, double amount);
  const std::vector<ContactRun>& runs() const { return runs_; }

 private:
  std::vector<ContactRun> runs_;
  bool touching_ = false;
};

/// Adds a warning for each run in which shank or holder entered the stock, at most
/// kWarningsMax.
void warn_of_stock_contacts(const ContactRuns& contacts, const Program& program,
                            std::vector<std::string>& warnings);
/// Adds a warning for each run in which any part of a tool touched an obstacle, at
/// most kWarningsMax.
void warn_of_obstacle_contacts(const ContactRuns& contacts, const Program& program,
                               std::vector<std::string>& warnings);

}  // namespace kerf
