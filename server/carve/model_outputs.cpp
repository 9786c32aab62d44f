#include "server/carve/model_outputs.h"

namespace kerf {

std::expected<std::uint64_t, std::string> write_model_choice(const ModelChoice& choice,
                                                             const std::filesystem::path& path,
                                                             const DexelSnapshot& snapshot,
                                                             const std::string& title,
                                                             const ModelProgress& progress) {
  SnapshotMesh mesh(snapshot);
  const auto written = write_model(
      path, mesh,
      {.format = choice.format, .encoding = choice.encoding, .title = title, .progress = progress});
  if (!written) return std::unexpected(written.error().reason);
  return written->triangles;
}

}  // namespace kerf
