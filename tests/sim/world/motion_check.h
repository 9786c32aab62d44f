// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tests/sim/world/hand.h"

namespace kerf::sim {

/// The motions of hands that need not be in the journal.
struct Allowance {
  bool any = false;  ///< NATS has lost messages
  /// Strokes that were undone or redone: a tool around which stock comes back cuts nothing with the
  /// motion that leaves it.
  std::uint64_t stroke_changes = 0;
};

/// Compares the motions that hands have made, whose links have ended, with those of a journal: each
/// is there once and in order. A sentence for each fault.
std::vector<std::string> check_motions(const std::filesystem::path& journal,
                                       std::span<const std::unique_ptr<Hand>> hands,
                                       const Allowance& allowance);

}  // namespace kerf::sim
