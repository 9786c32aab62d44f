// SPDX-License-Identifier: Apache-2.0
#include "server/carve/stock_contacts.h"

#include <algorithm>

namespace kerf {
namespace {

// Bounds the memory for a program with permanent contact and changing tools.
constexpr std::size_t kRunsMax = 100'000;

std::string warning_of(const ContactRun& run, const Program& program, const std::string& what) {
  std::string text = place_of(program, run.from_file, run.from_line) + ": " + what;
  if (run.to_file != run.from_file) {
    text += ", until " + place_of(program, run.to_file, run.to_line);
  } else if (run.to_line != run.from_line) {
    text += ", until line " + std::to_string(run.to_line);
  }
  return text;
}

}  // namespace

void ContactRuns::follow(const ProgramMotion& motion, double amount) {
  const bool goes_on = touching_ && runs_.back().tool == motion.tool;
  touching_ = amount > 0 && (goes_on || runs_.size() < kRunsMax);
  if (!touching_) return;
  if (!goes_on)
    runs_.push_back({.tool = motion.tool,
                     .from_file = motion.file,
                     .from_line = motion.line,
                     .tip_mm = motion.to.tip_mm});
  ContactRun& run = runs_.back();
  run.to_file = motion.file;
  run.to_line = motion.line;
  run.rapid = run.rapid || motion.rapid;
  if (amount <= run.worst) return;
  run.worst = amount;
  run.tip_mm = motion.to.tip_mm;
}

void warn_of_stock_contacts(const ContactRuns& contacts, const Program& program,
                            std::vector<std::string>& warnings) {
  for (std::size_t i = 0; i < std::min(contacts.runs().size(), kWarningsMax); ++i) {
    const ContactRun& run = contacts.runs()[i];
    warnings.push_back(warning_of(run, program,
                                  "shank or holder of tool " + std::to_string(run.tool) +
                                      " enters the stock, up to " + std::to_string(run.worst) +
                                      " mm deep"));
  }
}

void warn_of_obstacle_contacts(const ContactRuns& contacts, const Program& program,
                               std::vector<std::string>& warnings) {
  for (std::size_t i = 0; i < std::min(contacts.runs().size(), kWarningsMax); ++i) {
    const ContactRun& run = contacts.runs()[i];
    warnings.push_back(
        warning_of(run, program, "tool " + std::to_string(run.tool) + " touches an obstacle"));
  }
}

}  // namespace kerf
