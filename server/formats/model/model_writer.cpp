// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/model_writer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <system_error>

#include "server/formats/model/model_parts.h"
#include "server/formats/number_text.h"

namespace kerf {
namespace {

struct Kind {
  ModelFormat format;
  const char* name;
  const char* media_type;
  std::span<const ModelEncoding> encodings;
};

constexpr std::array kOfStl{ModelEncoding::kBinary, ModelEncoding::kAscii};
constexpr std::array kOfGlb{ModelEncoding::kFloat, ModelEncoding::kQuantized,
                            ModelEncoding::kMeshopt};
constexpr std::array kOf3mf{ModelEncoding::kXml};
constexpr std::array kOfPly{ModelEncoding::kBinary};
constexpr std::array kOfObj{ModelEncoding::kAscii};
constexpr Kind kKinds[] = {{ModelFormat::kStl, "stl", "model/stl", kOfStl},
                           {ModelFormat::kGlb, "glb", "model/gltf-binary", kOfGlb},
                           {ModelFormat::k3mf, "3mf", "model/3mf", kOf3mf},
                           {ModelFormat::kPly, "ply", "application/vnd.ply", kOfPly},
                           {ModelFormat::kObj, "obj", "model/obj", kOfObj}};

const Kind& kind_of(ModelFormat format) {
  return *std::ranges::find(kKinds, format, &Kind::format);
}

ModelResult write_format(const ModelOutput& output) {
  switch (output.request.format) {
    case ModelFormat::kStl:
      return output.request.encoding == ModelEncoding::kAscii ? write_stl_ascii(output)
                                                              : write_stl(output);
    case ModelFormat::kGlb:
      return write_glb(output);
    case ModelFormat::k3mf:
      return write_3mf(output);
    case ModelFormat::kPly:
      return write_ply(output);
    case ModelFormat::kObj:
      return write_obj(output);
  }
  return model_error("unknown model format");
}

}  // namespace

const char* to_string(ModelFormat format) { return kind_of(format).name; }
const char* media_type(ModelFormat format) { return kind_of(format).media_type; }
std::span<const ModelEncoding> model_encodings(ModelFormat format) {
  return kind_of(format).encodings;
}

const char* to_string(ModelEncoding encoding) {
  switch (encoding) {
    case ModelEncoding::kBinary:
      return "binary";
    case ModelEncoding::kAscii:
      return "ascii";
    case ModelEncoding::kFloat:
      return "float";
    case ModelEncoding::kQuantized:
      return "quantized";
    case ModelEncoding::kMeshopt:
      return "meshopt";
    case ModelEncoding::kXml:
      return "xml";
  }
  return "unknown";
}

std::optional<ModelFormat> model_format(std::string_view name) {
  const auto found =
      std::ranges::find(kKinds, name, [](const Kind& kind) { return std::string_view(kind.name); });
  return found == std::end(kKinds) ? std::nullopt : std::optional(found->format);
}

std::optional<ModelEncoding> model_encoding(ModelFormat format, std::string_view name) {
  for (const ModelEncoding encoding : model_encodings(format)) {
    if (name == to_string(encoding)) return encoding;
  }
  return std::nullopt;
}

ModelResult write_model(const std::filesystem::path& path, MeshSource& source,
                        const ModelRequest& request) {
  ModelResult written = model_error({});
  CoordinateLoss loss;
  {
    FileSink sink(path);
    if (sink.ok()) written = write_format({sink, path, source, request, loss});
    if (request.stop.stop_requested()) written = model_error("stopped");
    if (auto finished = sink.finish(); !finished) written = model_error(finished.error());
    if (written) {
      written->bytes = sink.bytes();
      written->collapsed = loss.collapsed;
      written->farthest_mm = static_cast<double>(loss.farthest_mm);
    }
  }
  if (!written) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
  }
  return written;
}

void ModelOutput::add_loss(const MeshPiece& piece) const {
  const Vec3 origin = origin_mm();
  for (std::size_t first = 0; first + 2 < piece.indices.size(); first += 3) {
    std::array<std::array<float, 3>, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      corners[c] = moved(piece.positions_mm[piece.indices[first + c]], origin);
      for (const float x : corners[c]) loss.farthest_mm = std::max(loss.farthest_mm, std::abs(x));
    }
    if (facet_normal(corners) == std::array<float, 3>{0, 0, 0}) ++loss.collapsed;
  }
}

std::string coarse_coordinates(const ModelSummary& summary, double pitch_mm, Vec3 least_mm,
                               Vec3 size_mm, std::string_view option) {
  // Nearer to the origin a shift gains little, because the size alone makes floats as coarse.
  constexpr double kFarSizes = 16;
  constexpr double kStepPitches = 1.0 / 16;
  const double size = std::max({size_mm.x, size_mm.y, size_mm.z});
  if (summary.farthest_mm < kFarSizes * size) return {};
  const auto far = static_cast<float>(summary.farthest_mm);
  const double step =
      static_cast<double>(std::nextafter(far, std::numeric_limits<float>::infinity()) - far);
  if (summary.collapsed == 0 && step <= kStepPitches * pitch_mm) return {};
  std::string text;
  if (summary.collapsed > 0) {
    text = std::to_string(summary.collapsed) + " of " + std::to_string(summary.triangles) +
           " triangles have no area: ";
  }
  text += "so far from the origin (" + exact_text(summary.farthest_mm) +
          " mm) the coordinates of the file are " + exact_text(step) + " mm apart; " +
          std::string(option);
  const char* before = option.ends_with('=') ? "" : " ";
  for (const double least : {least_mm.x, least_mm.y, least_mm.z}) {
    text += before + exact_text(0.0 - std::round(least));
    before = ",";
  }
  return text + " moves the model to the origin";
}

std::array<float, 3> facet_normal(const std::array<std::array<float, 3>, 3>& corners) {
  std::array<Vec3, 3> p;
  for (std::size_t c = 0; c < 3; ++c) {
    p[c] = {static_cast<double>(corners[c][0]), static_cast<double>(corners[c][1]),
            static_cast<double>(corners[c][2])};
  }
  const Vec3 n = cross(p[1] - p[0], p[2] - p[0]);
  const double size = length(n);
  if (!(size > 0)) return {0, 0, 0};
  return {static_cast<float>(n.x / size), static_cast<float>(n.y / size),
          static_cast<float>(n.z / size)};
}

std::string one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return line;
}

}  // namespace kerf
