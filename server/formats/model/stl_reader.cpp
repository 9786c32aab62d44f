// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/stl_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <string>

#include "server/formats/model/text_words.h"
#include "server/formats/stop_poll.h"

namespace kerf {
namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kFacetBytes = 50;

using Result = std::expected<std::vector<StlTriangle>, MeshFileError>;

std::unexpected<MeshFileError> error(MeshFileErrorCode code, std::string reason) {
  return std::unexpected(MeshFileError{code, std::move(reason)});
}

std::uint32_t get_u32(const std::byte* at) {
  std::uint32_t value = 0;
  for (int n = 0; n < 4; ++n) value |= std::to_integer<std::uint32_t>(at[n]) << (8 * n);
  return value;
}

double get_float(const std::byte* at) {
  return static_cast<double>(std::bit_cast<float>(get_u32(at)));
}

std::string too_many(std::uint64_t facets, std::uint64_t facets_max) {
  return std::to_string(facets) + " facets; the limit is " + std::to_string(facets_max);
}

Result read_binary(std::span<const std::byte> bytes, std::uint64_t facets_max,
                   const std::stop_token& stop) {
  if (bytes.size() < kHeaderBytes) {
    return error(MeshFileErrorCode::kTruncated, "the file ends after " +
                                                    std::to_string(bytes.size()) +
                                                    " bytes; a binary STL has a header of 84");
  }
  const std::uint64_t facets = get_u32(bytes.data() + 80);
  if (facets == 0) return error(MeshFileErrorCode::kEmpty, "the file contains no facet");
  if (facets > facets_max) return error(MeshFileErrorCode::kTooLarge, too_many(facets, facets_max));
  if (bytes.size() != stl_file_bytes(facets)) {
    const bool shorter = bytes.size() < stl_file_bytes(facets);
    return error(shorter ? MeshFileErrorCode::kTruncated : MeshFileErrorCode::kCountMismatch,
                 "the header announces " + std::to_string(facets) + " facets, that is " +
                     std::to_string(stl_file_bytes(facets)) + " bytes; the file has " +
                     std::to_string(bytes.size()));
  }
  std::vector<StlTriangle> triangles(static_cast<std::size_t>(facets));
  StopPoll poll(stop);
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (poll.stops()) return error(MeshFileErrorCode::kStopped, "stopped");
    const std::byte* at = bytes.data() + kHeaderBytes + f * kFacetBytes + 12;
    for (Vec3& corner : triangles[f]) {
      corner = {get_float(at), get_float(at + 4), get_float(at + 8)};
      at += 12;
      if (!is_finite(corner)) {
        return error(MeshFileErrorCode::kNotFinite,
                     "facet " + std::to_string(f + 1) + " has a coordinate that is not finite");
      }
    }
  }
  return triangles;
}

/// Parses statement by statement and stops at the first error.
class AsciiReader {
 public:
  AsciiReader(std::string_view text, std::uint64_t facets_max, const std::stop_token& stop)
      : words_(text), facets_max_(facets_max), poll_(stop) {}

  Result read() {
    while (!error_) {
      if (poll_.stops()) return error(MeshFileErrorCode::kStopped, "stopped");
      const std::string_view word = words_.next();
      if (word.empty()) break;
      if (equal_ignoring_case(word, "solid") || equal_ignoring_case(word, "endsolid")) {
        inside_ = equal_ignoring_case(word, "solid");
        words_.skip_line();  // the rest of the line is a name
      } else if (inside_ && equal_ignoring_case(word, "facet")) {
        read_facet();
      } else {
        fail_at(word, inside_ ? "facet or endsolid" : "solid");
      }
    }
    if (!error_ && inside_) fail(MeshFileErrorCode::kTruncated, "the file ends without endsolid");
    if (!error_ && triangles_.empty())
      fail(MeshFileErrorCode::kEmpty, "the file contains no facet");
    if (error_) return std::unexpected(*error_);
    return std::move(triangles_);
  }

 private:
  void read_facet() {
    if (triangles_.size() == facets_max_) {
      fail(MeshFileErrorCode::kTooLarge, too_many(triangles_.size() + 1, facets_max_));
      return;
    }
    expect("normal");
    // Normals are ignored. Exporters write nan for those of degenerate facets.
    for (int n = 0; n < 3 && !error_; ++n) words_.next();
    expect("outer");
    expect("loop");
    StlTriangle triangle;
    for (Vec3& corner : triangle) {
      expect("vertex");
      corner.x = number();
      corner.y = number();
      corner.z = number();
    }
    expect("endloop");
    expect("endfacet");
    if (!error_) triangles_.push_back(triangle);
  }

  void expect(std::string_view expected) {
    if (error_) return;
    const std::string_view word = words_.next();
    if (!equal_ignoring_case(word, expected)) fail_at(word, expected);
  }

  double number() {
    if (error_) return 0;
    const std::string_view word = words_.next();
    const auto value = word_number<double>(word);
    if (!value) {
      fail_at(word, "a number");
    } else if (!std::isfinite(*value)) {
      fail(MeshFileErrorCode::kNotFinite, "a coordinate is not finite: " + std::string(word));
    }
    return value.value_or(0);
  }

  void fail_at(std::string_view word, std::string_view expected) {
    if (word.empty()) {
      fail(MeshFileErrorCode::kTruncated, "the file ends before " + std::string(expected));
      return;
    }
    constexpr std::size_t kQuotedMax = 40;
    std::string reason = "\"";
    reason.append(word.substr(0, kQuotedMax)).append("\" instead of ").append(expected);
    fail(MeshFileErrorCode::kSyntax, reason);
  }

  void fail(MeshFileErrorCode code, const std::string& reason) {
    error_ = MeshFileError{code, "line " + std::to_string(words_.line()) + ": " + reason};
  }

  TextWords words_;
  std::uint64_t facets_max_;
  StopPoll poll_;
  bool inside_ = false;
  std::vector<StlTriangle> triangles_;
  std::optional<MeshFileError> error_;
};

bool looks_ascii(std::span<const std::byte> bytes) {
  constexpr std::string_view kSolid = "solid";
  constexpr std::size_t kLookMax = 512;
  if (bytes.size() < kSolid.size() ||
      !equal_ignoring_case({reinterpret_cast<const char*>(bytes.data()), kSolid.size()}, kSolid)) {
    return false;
  }
  const bool exact_binary =
      bytes.size() >= kHeaderBytes && bytes.size() == stl_file_bytes(get_u32(bytes.data() + 80));
  const auto head = bytes.first(std::min(bytes.size(), kLookMax));
  return !exact_binary && std::find(head.begin(), head.end(), std::byte{0}) == head.end();
}

}  // namespace

Result read_stl(std::span<const std::byte> bytes, std::uint64_t facets_max,
                const std::stop_token& stop) {
  if (!looks_ascii(bytes)) return read_binary(bytes, facets_max, stop);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return AsciiReader(text, facets_max, stop).read();
}

}  // namespace kerf
