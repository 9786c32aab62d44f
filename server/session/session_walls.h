// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>
#include <stop_token>

#include "kernel/dexel/dexel_snapshot.h"
#include "server/session/session_export.h"

namespace kerf {

/// Maximum number of motions searched for thin walls: about 0.4 GB.
inline constexpr std::size_t kWallMotionsMax = 1'000'000;

/// Writes, as a JSON object, the walls and grooves thinner than the pitch left by the motions of a
/// journal and its mesh stock, with their locations, and whether the scene's target holds there
/// (server/verify/README.md). `field`: the field of the block along Z after these motions. Fails
/// for more than kWallMotionsMax motions.
ExportResult export_thin_walls(const std::filesystem::path& journal, const DexelSnapshot& field,
                               std::ostream& out, const std::stop_token& stop = {});

}  // namespace kerf
