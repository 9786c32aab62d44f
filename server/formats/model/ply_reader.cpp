// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "server/formats/model/mesh_reader.h"
#include "server/formats/model/text_words.h"
#include "server/formats/stop_poll.h"

// Reads PLY 1.0 (Turk, The PLY polygon file format, 1994): a header that lists elements and their
// properties, then the elements as text or binary numbers. All announced elements are parsed; x, y,
// z of `vertex` and the list of `face` are kept.

namespace kerf {
namespace {

enum class Encoding { kAscii, kLittle, kBig };
struct Type {
  std::string_view name;
  std::size_t bytes;
  char kind;  ///< i: signed, u: unsigned, f: floating
};
constexpr Type kTypes[] = {
    {"char", 1, 'i'},  {"uchar", 1, 'u'},  {"short", 2, 'i'},   {"ushort", 2, 'u'},
    {"int", 4, 'i'},   {"uint", 4, 'u'},   {"float", 4, 'f'},   {"double", 8, 'f'},
    {"int8", 1, 'i'},  {"uint8", 1, 'u'},  {"int16", 2, 'i'},   {"uint16", 2, 'u'},
    {"int32", 4, 'i'}, {"uint32", 4, 'u'}, {"float32", 4, 'f'}, {"float64", 8, 'f'}};
struct Property {
  std::string name;
  const Type* type = nullptr;
  const Type* count_type = nullptr;  ///< of a list
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

constexpr std::size_t kHeaderBytesMax = std::size_t{1} << 16;
constexpr std::uint64_t kListMax = 100'000;

class PlyReader {
 public:
  PlyReader(std::span<const std::byte> bytes, std::uint64_t triangles_max,
            const std::stop_token& stop)
      : text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()),
        words_(text_),
        triangles_max_(triangles_max),
        poll_(stop) {}

  MeshFileResult read() {
    read_header();
    for (const Element& element : elements_) {
      if (!error_) read_element(element);
    }
    if (!error_ && mesh_.triangles.empty()) {
      fail(MeshFileErrorCode::kEmpty, "the file contains no face");
    }
    if (!error_ && encoding_ != Encoding::kAscii && at_ < text_.size()) {
      fail(MeshFileErrorCode::kCountMismatch,
           std::to_string(text_.size() - at_) + " bytes follow the last element");
    }
    if (error_) return std::unexpected(*error_);
    return std::move(mesh_);
  }

 private:
  void read_header() {
    const std::size_t end = text_.substr(0, kHeaderBytesMax).find("end_header");
    if (!text_.starts_with("ply") || end == text_.npos) {
      fail(MeshFileErrorCode::kSyntax,
           "a PLY file begins with 'ply' and its header ends with 'end_header'");
      return;
    }
    words_.skip_line();
    for (std::string_view word = words_.next(); !error_ && word != "end_header";
         word = words_.next()) {
      if (word == "format") {
        read_format();
      } else if (word == "element") {
        Element element{std::string(words_.next_in_line()), 0, {}};
        const auto count = word_number<std::uint64_t>(words_.next_in_line());
        if (!count) fail_line("an element has no count");
        element.count = count.value_or(0);
        elements_.push_back(std::move(element));
      } else if (word == "property") {
        read_property();
      } else if (word == "comment" || word == "obj_info") {
        words_.skip_line();
      } else {
        fail_line('"' + std::string(word.substr(0, 40)) + "\" is not a header statement");
      }
    }
    at_ = words_.position();
    if (at_ < text_.size() && text_[at_] == '\r') ++at_;
    if (at_ < text_.size() && text_[at_] == '\n') ++at_;
  }

  void read_format() {
    const std::string_view name = words_.next_in_line();
    if (name == "ascii") {
      encoding_ = Encoding::kAscii;
    } else if (name == "binary_little_endian") {
      encoding_ = Encoding::kLittle;
    } else if (name == "binary_big_endian") {
      encoding_ = Encoding::kBig;
    } else {
      fail(MeshFileErrorCode::kUnsupported,
           "the format must be ascii, binary_little_endian or "
           "binary_big_endian");
    }
    words_.skip_line();
  }

  static const Type* find_type(std::string_view name) {
    const auto found = std::ranges::find(kTypes, name, &Type::name);
    return found == std::end(kTypes) ? nullptr : found;
  }

  void read_property() {
    Property property;
    std::string_view word = words_.next_in_line();
    const bool list = word == "list";
    if (list) {
      property.count_type = find_type(words_.next_in_line());
      word = words_.next_in_line();
    }
    property.type = find_type(word);
    property.name = words_.next_in_line();
    const bool bad_list =
        list && (property.count_type == nullptr || property.count_type->kind == 'f');
    if (elements_.empty() || property.type == nullptr || bad_list || property.name.empty()) {
      fail_line("a property has no element, no name or no type");
      return;
    }
    elements_.back().properties.push_back(std::move(property));
  }

  void read_element(const Element& element) {
    const bool vertices = element.name == "vertex";
    if (element.properties.empty()) return;
    if (vertices) check_vertex(element);
    for (std::uint64_t n = 0; n < element.count && !error_; ++n) {
      place_ = element.name + " " + std::to_string(n);
      Vec3 position;
      for (const Property& property : element.properties) {
        if (property.count_type != nullptr) {
          read_list(property, element.name);
          continue;
        }
        const double value = number(*property.type);
        if (property.name == "x") position.x = value;
        if (property.name == "y") position.y = value;
        if (property.name == "z") position.z = value;
        if (error_) return;
      }
      if (!vertices) continue;
      if (!is_finite(position)) {
        fail(MeshFileErrorCode::kNotFinite, place_ + " has a coordinate that is not finite");
      }
      mesh_.vertices_mm.push_back(position);
    }
  }

  void check_vertex(const Element& element) {
    for (const char* axis : {"x", "y", "z"}) {
      const auto is_axis = [axis](const Property& p) { return p.name == axis && !p.count_type; };
      if (std::ranges::none_of(element.properties, is_axis)) {
        fail(MeshFileErrorCode::kSyntax, std::string("the vertices have no ") + axis);
      }
    }
  }

  void read_list(const Property& property, std::string_view element) {
    const double announced = number(*property.count_type);
    if (error_) return;
    const bool corners = property.name == "vertex_indices" || property.name == "vertex_index";
    const bool strips = element == "tristrips" && corners;
    if (!(announced >= 0 && (strips || announced <= double(kListMax)))) {
      fail(MeshFileErrorCode::kSyntax, place_ + " has a list of invalid length");
      return;
    }
    list_.clear();
    for (std::uint64_t n = 0; n < std::uint64_t(announced) && !error_; ++n) {
      list_.push_back(number(*property.type));
    }
    if (error_) return;
    if (strips) add_strips();
    if (element == "face" && corners) add_face();
  }

  void add_face() {
    for (std::size_t c = 2; c < list_.size() && !error_; ++c) {
      add_triangle(list_[0], list_[c - 1], list_[c]);
    }
  }

  /// Adds strips of triangles, as in files of the Stanford repository; -1 begins the next.
  void add_strips() {
    std::size_t first = 0;
    for (std::size_t c = 0; c < list_.size() && !error_; ++c) {
      if (list_[c] < 0) first = c + 1;
      if (c < first + 2) continue;
      const bool odd = (c - first) % 2 != 0;
      add_triangle(list_[c - 2], list_[odd ? c : c - 1], list_[odd ? c - 1 : c]);
    }
  }

  void add_triangle(double a, double b, double c) {
    const auto count = static_cast<double>(mesh_.vertices_mm.size());
    for (const double corner : {a, b, c}) {
      if (!(corner >= 0 && corner < count && corner == std::floor(corner))) {
        fail(MeshFileErrorCode::kBadIndex, place_ + " has a vertex index out of range");
        return;
      }
    }
    if (mesh_.triangles.size() == triangles_max_) {
      fail(MeshFileErrorCode::kTooLarge,
           "the file has more than " + std::to_string(triangles_max_) + " triangles, the limit");
      return;
    }
    mesh_.triangles.push_back({std::uint32_t(a), std::uint32_t(b), std::uint32_t(c)});
  }

  double number(const Type& type) {
    if (poll_.stops()) fail(MeshFileErrorCode::kStopped, "stopped");
    return encoding_ == Encoding::kAscii ? ascii_number() : binary_number(type);
  }

  double ascii_number() {
    const std::string_view word = words_.next();
    const auto value = word_number<double>(word);
    if (!value) {
      fail(word.empty() ? MeshFileErrorCode::kTruncated : MeshFileErrorCode::kSyntax,
           place_ + (word.empty()
                         ? ": the file ends here"
                         : ": \"" + std::string(word.substr(0, 40)) + "\" is not a number"));
    }
    return value.value_or(0);
  }

  double binary_number(const Type& type) {
    if (text_.size() - at_ < type.bytes) {
      fail(MeshFileErrorCode::kTruncated, place_ + ": the file ends here");
      return 0;
    }
    std::uint64_t bits = 0;
    for (std::size_t n = 0; n < type.bytes; ++n) {
      const std::size_t from = encoding_ == Encoding::kLittle ? type.bytes - 1 - n : n;
      bits = bits << 8U | static_cast<unsigned char>(text_[at_ + from]);
    }
    at_ += type.bytes;
    if (type.kind == 'f') {
      return type.bytes == 8 ? std::bit_cast<double>(bits)
                             : double(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    }
    if (type.kind == 'u') return static_cast<double>(bits);
    const auto unused = static_cast<int>(64 - 8 * type.bytes);
    return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
  }

  void fail_line(const std::string& reason) {
    fail(MeshFileErrorCode::kSyntax, "line " + std::to_string(words_.line()) + ": " + reason);
  }
  void fail(MeshFileErrorCode code, const std::string& reason) {
    if (!error_) error_ = MeshFileError{code, reason};
  }

  std::string_view text_;
  TextWords words_;  ///< the header, and the elements if they are text
  std::uint64_t triangles_max_;
  StopPoll poll_;
  Encoding encoding_ = Encoding::kAscii;
  std::size_t at_ = 0;  ///< of the next binary number
  std::vector<Element> elements_;
  std::vector<double> list_;
  std::string place_;
  TriangleMesh mesh_;
  std::optional<MeshFileError> error_;
};

}  // namespace

MeshFileResult read_ply(std::span<const std::byte> bytes, std::uint64_t triangles_max,
                        const std::stop_token& stop) {
  return PlyReader(bytes, triangles_max, stop).read();
}

}  // namespace kerf
