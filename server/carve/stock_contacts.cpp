#include "server/carve/stock_contacts.h"

#include <algorithm>

namespace kerf {
namespace {

constexpr std::size_t kWarningsMax = 20;

}  // namespace

void StockContacts::follow(const ProgramMotion& motion, double depth_mm) {
  const bool before = touching_ && runs_.back().tool == motion.tool;
  touching_ = depth_mm > 0;
  if (!touching_) return;
  if (!before) runs_.push_back({motion.tool, motion.line, motion.line, 0});
  Run& run = runs_.back();
  run.to_line = motion.line;
  run.depth_mm = std::max(run.depth_mm, depth_mm);
}

void StockContacts::warn(const std::string& program, std::vector<std::string>& warnings) const {
  for (std::size_t i = 0; i < std::min(runs_.size(), kWarningsMax); ++i) {
    const Run& run = runs_[i];
    std::string text = program + ":" + std::to_string(run.from_line) +
                       ": shank or holder of tool " + std::to_string(run.tool) +
                       " goes into the stock, up to " + std::to_string(run.depth_mm) + " mm deep";
    if (run.to_line != run.from_line) text += ", until line " + std::to_string(run.to_line);
    warnings.push_back(std::move(text));
  }
}

}  // namespace kerf
