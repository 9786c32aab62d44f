#pragma once

#include <string>
#include <vector>

#include "server/formats/program.h"

namespace kerf {

/// Where shank or holder of a tool went into the stock: one warning for a run of motions, not one
/// for each.
class StockContacts {
 public:
  /// The next motion of the program, and how deep they were in the stock (0: not at all).
  void follow(const ProgramMotion& motion, double depth_mm);
  /// Adds "program:line: …" for each run, the first 20 of them.
  void warn(const std::string& program, std::vector<std::string>& warnings) const;

 private:
  struct Run {
    ToolId tool;
    std::uint32_t from_line, to_line;
    double depth_mm;
  };
  std::vector<Run> runs_;
  bool touching_ = false;
};

}  // namespace kerf
