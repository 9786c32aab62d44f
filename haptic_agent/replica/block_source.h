// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <map>
#include <string>
#include <string_view>

#include "kernel/sculpture.h"

namespace kerf::agent {

/// The block as a welcome describes it: what every copy begins with.
class BlockSource {
 public:
  /// Reads the text of a welcome. The error says what of it cannot be understood.
  static std::expected<BlockSource, std::string> read(std::string_view welcome);

  /// The untouched block with the session's tools, without obstacles: those push the tool however
  /// far the server is, for planes stay right (ContactModel). Of a stock that is a mesh, the box
  /// around it; the server tells what of it is not solid.
  Sculpture make() const;
  /// Fastest cutting tip that the server takes.
  double speed_max_mm_per_s() const { return speed_max_mm_per_s_; }

 private:
  SculptureSettings settings_;
  std::map<ToolId, Tool> tools_;
  double speed_max_mm_per_s_ = 0;
};

}  // namespace kerf::agent
