// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "server/formats/model/mesh_source.h"

namespace kerf {

enum class ModelFormat : std::uint8_t { kStl, kGlb, k3mf, kPly, kObj };
inline constexpr std::array kModelFormats{ModelFormat::kStl, ModelFormat::kGlb, ModelFormat::k3mf,
                                          ModelFormat::kPly, ModelFormat::kObj};
/// Encoding of a format. model_encodings() lists those of each format.
enum class ModelEncoding : std::uint8_t {
  kBinary,     ///< STL, PLY
  kAscii,      ///< STL, OBJ
  kFloat,      ///< GLB: float32 positions and normals
  kQuantized,  ///< GLB: KHR_mesh_quantization, int16 positions, int8 normals
  kMeshopt,    ///< GLB: the same, with EXT_meshopt_compression
  kXml         ///< 3MF
};

/// Returns the name of the format, which is its file extension: "stl", "glb", "3mf", "ply", "obj".
const char* to_string(ModelFormat format);
/// Returns "binary", "ascii", "float", "quantized", "meshopt" or "xml".
const char* to_string(ModelEncoding encoding);
/// Returns the media type of the format, e.g. "model/stl".
const char* media_type(ModelFormat format);
/// Returns the format of a name, or empty if unknown.
std::optional<ModelFormat> model_format(std::string_view name);
/// Returns the encodings of a format, the default first.
std::span<const ModelEncoding> model_encodings(ModelFormat format);
/// Returns the encoding of a name, or empty if the format does not have it.
std::optional<ModelEncoding> model_encoding(ModelFormat format, std::string_view name);

/// Receives the fraction of the work done, 0 to 1, at intervals; may be empty.
using ModelProgress = std::function<void(double)>;

struct ModelError {
  std::string reason;  ///< one sentence
};
struct ModelSummary {
  std::uint64_t triangles = 0, vertices = 0, bytes = 0;
  /// Triangles whose corners coincide, or are collinear, after rounding to floats in the scene, or
  /// 0 for a GLB, whose positions are relative to the block.
  std::uint64_t collapsed = 0;
  double farthest_mm = 0;  ///< greatest magnitude of a coordinate in the file; 0 for a GLB
};

struct ModelRequest {
  ModelFormat format = ModelFormat::kStl;
  ModelEncoding encoding = ModelEncoding::kBinary;
  std::string title = {};  ///< name of the model in the file
  Vec3 shift_mm = {};      ///< added to the coordinates of the scene
  ModelProgress progress = {};
  std::stop_token stop = {};  ///< polled before each piece of the surface
};

/// Returns why the coordinates of a file are too coarse for its surface, as one sentence with
/// numbers and the shift that helps, or an empty text. `pitch_mm`: between the rays of the block;
/// `least_mm`: its corner in the scene; `option`: the option for a shift, such as
/// "--model-translate". Coordinates are too coarse if the block is far from the origin for its size
/// and either triangles collapse or the step of a float exceeds a sixteenth of the pitch.
std::string coarse_coordinates(const ModelSummary& summary, double pitch_mm, Vec3 least_mm,
                               Vec3 size_mm, std::string_view option);

/// Writes a surface to a file in scene coordinates, mm (for GLB below the root node, see
/// README.md). Holds one piece of the source in memory, the seams of a row of pieces and, for GLB,
/// one group of at most 65,535 vertices. Data for the end of the file is spooled to an unnamed file
/// next to it. Equal sources give equal bytes. On error, and if a stop was requested, no file
/// remains.
std::expected<ModelSummary, ModelError> write_model(const std::filesystem::path& path,
                                                    MeshSource& source,
                                                    const ModelRequest& request);

}  // namespace kerf
