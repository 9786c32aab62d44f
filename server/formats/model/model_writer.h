// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "server/formats/model/mesh_source.h"

namespace kerf {

enum class ModelFormat : std::uint8_t { kStl, kGlb, k3mf, kPly, kObj };
inline constexpr std::array kModelFormats{ModelFormat::kStl, ModelFormat::kGlb, ModelFormat::k3mf,
                                          ModelFormat::kPly, ModelFormat::kObj};
/// How a format is written; each format has the ones that model_encodings names.
enum class ModelEncoding : std::uint8_t {
  kBinary,     ///< STL, PLY
  kAscii,      ///< STL, OBJ
  kFloat,      ///< GLB: float32 positions and normals
  kQuantized,  ///< GLB: KHR_mesh_quantization, int16 positions, int8 normals
  kMeshopt,    ///< GLB: the same, with EXT_meshopt_compression
  kXml         ///< 3MF
};

/// The extension without a dot, "stl", "glb", "3mf", "ply", "obj"; also what the format is called.
const char* to_string(ModelFormat format);
/// "binary", "ascii", "float", "quantized", "meshopt", "xml".
const char* to_string(ModelEncoding encoding);
/// What HTTP calls the format, e.g. "model/stl".
const char* media_type(ModelFormat format);
/// The format of that name; none if there is none.
std::optional<ModelFormat> model_format(std::string_view name);
/// The encodings of a format; the first one is the default.
std::span<const ModelEncoding> model_encodings(ModelFormat format);
/// The encoding of that name, if the format has it.
std::optional<ModelEncoding> model_encoding(ModelFormat format, std::string_view name);

/// Called now and then with the share of the work done, 0 to 1; may be empty.
using ModelProgress = std::function<void(double)>;

struct ModelError {
  std::string reason;  ///< one sentence
};
struct ModelSummary {
  std::uint64_t triangles = 0, vertices = 0, bytes = 0;
};

struct ModelRequest {
  ModelFormat format = ModelFormat::kStl;
  ModelEncoding encoding = ModelEncoding::kBinary;
  std::string title = {};  ///< the scene's name, as the file will call the model
  ModelProgress progress = {};
};

/// Writes a surface into a file: coordinates are the scene's, mm (in GLB below the root node, see
/// README.md). Needs memory for one piece of the source, the seams of a row of pieces and, for GLB,
/// one group of at most 65,535 vertices; what a format wants at its end waits in a nameless file
/// beside it. Equal sources give equal bytes. On an error no file is left behind.
std::expected<ModelSummary, ModelError> write_model(const std::filesystem::path& path,
                                                    MeshSource& source,
                                                    const ModelRequest& request);

}  // namespace kerf
