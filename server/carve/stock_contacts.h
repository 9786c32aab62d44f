// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/formats/program.h"

namespace kerf {

/// Motions one after the other, with one tool, in which something was touched that must not be.
struct ContactRun {
  ToolId tool = 0;
  std::uint32_t from_file = 0, from_line = 0, to_file = 0, to_line = 0;
  double worst = 0;    ///< depth, mm, or force, N
  Vec3 tip_mm;         ///< at the end of the motion where it was worst
  bool rapid = false;  ///< a rapid was among them
};

/// Collects them: one entry for a run of motions, not one for each.
class ContactRuns {
 public:
  /// The next motion of the program, and how bad it was (0: no contact).
  void follow(const ProgramMotion& motion, double amount);
  const std::vector<ContactRun>& runs() const { return runs_; }

 private:
  std::vector<ContactRun> runs_;
  bool touching_ = false;
};

/// Adds a warning for each run in which shank or holder went into the stock, the first 20 of them.
void warn_of_stock_contacts(const ContactRuns& contacts, const Program& program,
                            std::vector<std::string>& warnings);
/// The same of runs in which any part of a tool touched an obstacle.
void warn_of_obstacle_contacts(const ContactRuns& contacts, const Program& program,
                               std::vector<std::string>& warnings);

}  // namespace kerf
