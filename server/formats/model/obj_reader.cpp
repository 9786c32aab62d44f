// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <string>

#include "server/formats/model/mesh_reader.h"
#include "server/formats/model/text_words.h"
#include "server/formats/stop_poll.h"

// Reads the polygon statements of Wavefront OBJ (specification of 1995). Other statements are known
// by name and skipped.

namespace kerf {
namespace {

constexpr std::string_view kPassedOver[] = {
    "vn",     "vt",       "vp",       "o",          "g",        "s",   "mg",
    "usemtl", "mtllib",   "usemap",   "l",          "p",        "lod", "bevel",
    "maplib", "c_interp", "d_interp", "shadow_obj", "trace_obj"};

/// Returns whether a line that begins with `word` has no geometry: a comment or a skipped
/// statement.
bool is_skipped(std::string_view word) {
  return word.starts_with('#') || std::ranges::find(kPassedOver, word) != std::end(kPassedOver);
}

class ObjReader {
 public:
  ObjReader(std::string_view text, std::uint64_t triangles_max, const std::stop_token& stop)
      : words_(text, true), triangles_max_(triangles_max), poll_(stop) {}

  MeshFileResult read() {
    for (std::string_view word = words_.next(); !word.empty() && !error_; word = words_.next()) {
      if (poll_.stops()) {
        fail(MeshFileErrorCode::kStopped, "stopped");
      } else if (is_skipped(word)) {
        words_.skip_line();
      } else if (word == "v") {
        read_vertex();
      } else if (word == "f" || word == "fo") {
        read_face();
      } else {
        fail(MeshFileErrorCode::kSyntax, quoted(word) + " is not a statement of polygonal OBJ");
      }
    }
    if (!error_ && mesh_.triangles.empty()) {
      fail(MeshFileErrorCode::kEmpty, "the file contains no face");
    }
    if (error_) return std::unexpected(*error_);
    return std::move(mesh_);
  }

 private:
  static std::string quoted(std::string_view word) {
    constexpr std::size_t kQuotedMax = 40;
    return '"' + std::string(word.substr(0, kQuotedMax)) + '"';
  }

  void read_vertex() {
    std::array<double, 3> p{};
    for (double& c : p) {
      const std::string_view word = words_.next_in_line();
      const auto number = word_number<double>(word);
      if (!number) {
        fail(MeshFileErrorCode::kSyntax, quoted(word) + " instead of a coordinate");
        return;
      }
      if (!std::isfinite(*number)) {
        fail(MeshFileErrorCode::kNotFinite, "a coordinate is not finite: " + std::string(word));
        return;
      }
      c = *number;
    }
    words_.skip_line();  // a weight or a color
    mesh_.vertices_mm.push_back({p[0], p[1], p[2]});
  }

  void read_face() {
    std::vector<std::uint32_t> corners;
    for (auto word = words_.next_in_line(); !word.empty(); word = words_.next_in_line()) {
      const auto corner = read_corner(word);
      if (!corner) return;
      corners.push_back(*corner);
    }
    if (corners.size() < 3) {
      fail(MeshFileErrorCode::kSyntax, "a face has fewer than three corners");
      return;
    }
    for (std::size_t c = 2; c < corners.size(); ++c) {
      if (mesh_.triangles.size() == triangles_max_) {
        fail(MeshFileErrorCode::kTooLarge,
             "the file has more than " + std::to_string(triangles_max_) + " triangles, the limit");
        return;
      }
      mesh_.triangles.push_back({corners[0], corners[c - 1], corners[c]});
    }
  }

  /// Parses "7", "7/1", "7/1/2" or "7//2". Negative numbers count back from the newest vertex.
  std::optional<std::uint32_t> read_corner(std::string_view word) {
    const auto number = word_number<std::int64_t>(word.substr(0, word.find('/')));
    if (!number) {
      fail(MeshFileErrorCode::kSyntax, quoted(word) + " instead of a vertex number");
      return std::nullopt;
    }
    const auto count = static_cast<std::int64_t>(mesh_.vertices_mm.size());
    const std::int64_t index = *number < 0 ? count + *number : *number - 1;
    if (index < 0 || index >= count || *number == 0) {
      fail(MeshFileErrorCode::kBadIndex, "vertex number " + std::to_string(*number) +
                                             " is out of range: " + std::to_string(count) +
                                             " vertices are defined");
      return std::nullopt;
    }
    return static_cast<std::uint32_t>(index);
  }

  void fail(MeshFileErrorCode code, const std::string& reason) {
    error_ = MeshFileError{code, "line " + std::to_string(words_.line()) + ": " + reason};
  }

  TextWords words_;
  std::uint64_t triangles_max_;
  StopPoll poll_;
  TriangleMesh mesh_;
  std::optional<MeshFileError> error_;
};

/// Returns text in UTF-16 with a byte order mark as bytes, or empty for other text. Only comments
/// and names have characters beyond ASCII: each becomes a question mark.
std::optional<std::string> narrow_text(std::string_view text) {
  const bool little = text.starts_with("\xff\xfe"), big = text.starts_with("\xfe\xff");
  if (!little && !big) return std::nullopt;
  std::string narrow;
  narrow.reserve(text.size() / 2);
  for (std::size_t at = 2; at + 1 < text.size(); at += 2) {
    const char low = text[at + (little ? 0 : 1)], high = text[at + (little ? 1 : 0)];
    narrow += high == 0 && static_cast<unsigned char>(low) < 0x80 ? low : '?';
  }
  return narrow;
}

}  // namespace

MeshFileResult read_obj(std::string_view text, std::uint64_t triangles_max,
                        const std::stop_token& stop) {
  if (const auto narrow = narrow_text(text)) return ObjReader(*narrow, triangles_max, stop).read();
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return ObjReader(text, triangles_max, stop).read();
}

}  // namespace kerf
