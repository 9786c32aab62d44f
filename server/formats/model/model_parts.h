// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <charconv>
#include <filesystem>
#include <string>
#include <string_view>

#include "server/formats/model/file_sink.h"
#include "server/formats/model/model_writer.h"

namespace kerf {

/// Loss of a surface by rounding scene coordinates to floats.
struct CoordinateLoss {
  std::uint64_t collapsed = 0;
  float farthest_mm = 0;
};

/// Arguments of a format's writer. model_writer.cpp selects the writer.
struct ModelOutput {
  FileSink& sink;
  const std::filesystem::path& path;  ///< of the sink; temporary files are created next to it
  MeshSource& source;
  const ModelRequest& request;
  CoordinateLoss& loss;

  /// Reads the next piece and reports the progress. Returns false at the end, and if a stop was
  /// requested.
  bool next(MeshPiece& piece) const {
    if (request.stop.stop_requested() || !source.next(piece)) return false;
    if (request.format != ModelFormat::kGlb) add_loss(piece);
    if (request.progress) request.progress(source.share());
    return true;
  }
  /// File coordinates of the source's position (0, 0, 0).
  Vec3 origin_mm() const { return source.origin_mm() + request.shift_mm; }
  /// Counts the loss of a piece by in_scene().
  void add_loss(const MeshPiece& piece) const;
  /// Converts a position to coordinates of the file.
  std::array<float, 3> in_scene(const std::array<float, 3>& p) const {
    return moved(p, origin_mm());
  }

 private:
  static std::array<float, 3> moved(const std::array<float, 3>& p, Vec3 by) {
    return {static_cast<float>(by.x + static_cast<double>(p[0])),
            static_cast<float>(by.y + static_cast<double>(p[1])),
            static_cast<float>(by.z + static_cast<double>(p[2]))};
  }
};

using ModelResult = std::expected<ModelSummary, ModelError>;
ModelResult write_stl(const ModelOutput& output);
ModelResult write_stl_ascii(const ModelOutput& output);
ModelResult write_glb(const ModelOutput& output);
ModelResult write_3mf(const ModelOutput& output);
ModelResult write_ply(const ModelOutput& output);
ModelResult write_obj(const ModelOutput& output);

inline std::unexpected<ModelError> model_error(std::string reason) {
  return std::unexpected(ModelError{std::move(reason)});
}

/// Appends little-endian bytes.
inline void put_u32(std::vector<std::byte>& out, std::uint32_t value) {
  for (unsigned n = 0; n < 4; ++n) out.push_back(static_cast<std::byte>(value >> (8 * n)));
}
inline void put_float(std::vector<std::byte>& out, float value) {
  put_u32(out, std::bit_cast<std::uint32_t>(value));
}

/// Appends the shortest decimal text that parses to the same value.
template <class T>
void put_number(std::string& out, T value) {
  std::array<char, 24> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  out.append(digits.data(), end);
}

/// Appends `word` and the numbers, with a space before each.
inline void put_vector(std::string& out, std::string_view word, const std::array<float, 3>& v) {
  out += word;
  for (const float c : v) {
    out += ' ';
    put_number(out, c);
  }
}

/// Returns the unit normal of a triangle, or zero if its corners are collinear.
std::array<float, 3> facet_normal(const std::array<std::array<float, 3>, 3>& corners);

/// Returns the name without control characters.
std::string one_line(std::string_view text);

}  // namespace kerf
