// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <map>
#include <string>
#include <string_view>

#include "kernel/sculpture.h"

namespace kerf::agent {

/// Settings and tools of the block, as read from the welcome. Creates the initial replica.
class BlockSource {
 public:
  /// Parses the text of a welcome. The error is one sentence.
  static std::expected<BlockSource, std::string> read(std::string_view welcome);

  /// Adds the tools of a `tools` message that are new. Returns them; the error is one sentence.
  std::expected<std::map<ToolId, Tool>, std::string> add_tools(std::string_view message);

  /// Lets the block keep the normals that meshes need (mesh_tile). The forces need none.
  void keep_normals() { settings_.keep_normals = true; }

  /// Returns the uncut block with the session's tools, without obstacles, whose contact is rendered
  /// from the server's contact planes (ContactModel). A mesh stock is replaced by its bounding box.
  /// The server sends which parts of it are empty.
  Sculpture make() const;
  /// Returns an upper bound of the engaged area of a cut with a tool, mm²: the width of the tool
  /// times its cutting length, or the stock's diagonal if that is shorter. 0 for an unknown tool.
  double full_cut_mm2(ToolId tool) const;
  /// Law and coefficients of the session's forces.
  const ForceSettings& force() const { return settings_.force; }
  /// Maximum speed of the cutting tip that the server accepts.
  double speed_max_mm_per_s() const { return speed_max_mm_per_s_; }

 private:
  SculptureSettings settings_;
  std::map<ToolId, Tool> tools_;
  double speed_max_mm_per_s_ = 0;
};

}  // namespace kerf::agent
