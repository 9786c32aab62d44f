#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "server/formats/model/model_writer.h"

namespace kerf {

/// One model file that the command line asks for.
struct ModelChoice {
  ModelFormat format = ModelFormat::kStl;
  std::filesystem::path path;
  ModelEncoding encoding = ModelEncoding::kBinary;
};

/// Writes one of them into `path` (which may differ from the one asked for); the triangles of it.
/// The error is one sentence.
std::expected<std::uint64_t, std::string> write_model_choice(const ModelChoice& choice,
                                                             const std::filesystem::path& path,
                                                             const DexelSnapshot& snapshot,
                                                             const std::string& title,
                                                             const ModelProgress& progress);

}  // namespace kerf
