// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/threemf_part.h"

#include <expat.h>

#include <cmath>
#include <memory>
#include <optional>

#include "server/formats/model/mesh_rejection.h"
#include "server/formats/model/text_words.h"

namespace kerf {
namespace {

struct FreeParser {
  void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
};
using ParserPointer = std::unique_ptr<std::remove_pointer_t<XML_Parser>, FreeParser>;

/// The attributes of an XML element. Names are `namespace name`, or `name`.
class Attributes {
 public:
  explicit Attributes(const char** list) : list_(list) {}
  std::optional<std::string_view> find(std::string_view name) const {
    for (const char** at = list_; *at != nullptr; at += 2) {
      if (name == *at) return at[1];
    }
    return std::nullopt;
  }

 private:
  const char** list_;
};

constexpr std::string_view kCore = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02 ";
constexpr std::string_view kPath =
    "http://schemas.microsoft.com/3dmanufacturing/production/2015/06 path";

constexpr std::uint64_t kObjectsMax = 100'000;
constexpr std::uint64_t kElementBytesMax = std::uint64_t{1} << 20U;

/// Parses one model part. Expat calls it for each element.
class PartReader {
 public:
  PartReader(std::string name, ThreemfCount& count)
      : name_(std::move(name)), count_(count), parser_(XML_ParserCreateNS(nullptr, ' ')) {
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), &begin_element, &end_element);
    XML_SetDoctypeDeclHandler(parser_.get(), &begin_doctype, nullptr);
  }

  void take(std::string_view text) { parse(text, false); }
  ThreemfPart finish() {
    parse({}, true);
    return std::move(part_);
  }

 private:
  void parse(std::string_view text, bool last) {
    const auto state =
        XML_Parse(parser_.get(), text.data(), static_cast<int>(text.size()), last ? 1 : 0);
    given_ += text.size();
    // Expat does not process each part of a long element, and then reports no position.
    const auto begun = XML_GetCurrentByteIndex(parser_.get());
    if (begun >= 0) begun_ = static_cast<std::uint64_t>(begun);
    if (!failure_ && state == XML_STATUS_OK && given_ - begun_ > kElementBytesMax)
      fail(MeshFileErrorCode::kTooLarge, "an element or a comment has more than 1 MB");
    if (failure_) throw MeshRejection{*failure_};
    if (state != XML_STATUS_OK)
      reject_mesh(MeshFileErrorCode::kSyntax,
                  where() + XML_ErrorString(XML_GetErrorCode(parser_.get())));
  }

  std::string where() const {
    return name_ + ", line " + std::to_string(XML_GetCurrentLineNumber(parser_.get())) + ": ";
  }

  // Expat is C: exceptions must not pass through it.
  void fail(MeshFileErrorCode code, const std::string& reason) {
    if (!failure_) failure_ = MeshFileError{code, where() + reason};
    XML_StopParser(parser_.get(), XML_FALSE);
  }

  void fail_too_large(const std::string& what) {
    fail(MeshFileErrorCode::kTooLarge, "the file has " + what + "more than " +
                                           std::to_string(count_.triangles_max) +
                                           " triangles, the limit");
  }

  void count_object() {
    if (++count_.objects > kObjectsMax)
      fail(MeshFileErrorCode::kTooLarge,
           "the file has more than 100000 objects, components and items, the limit");
  }

  static void begin_doctype(void* self, const char*, const char*, const char*, int) {
    static_cast<PartReader*>(self)->fail(MeshFileErrorCode::kSyntax,
                                         "a document type is not allowed in 3MF");
  }
  static void end_element(void* self, const char* name) {
    if (std::string_view(name) == std::string(kCore) + "object")
      static_cast<PartReader*>(self)->object_ = nullptr;
  }
  static void begin_element(void* self, const char* name, const char** attributes) {
    std::string_view element = name;
    if (!element.starts_with(kCore)) return;
    element.remove_prefix(kCore.size());
    static_cast<PartReader*>(self)->begin(element, Attributes(attributes));
  }

  void begin(std::string_view element, const Attributes& attributes) {
    if (failure_) return;
    if (element == "vertex") return read_vertex(attributes);
    if (element == "triangle") return read_triangle(attributes);
    if (element == "model") return read_model(attributes);
    if (element == "object") return read_object(attributes);
    if (element == "component" && object_ != nullptr)
      return read_placed(attributes, object_->components);
    if (element == "item") read_placed(attributes, part_.items);
  }

  void read_model(const Attributes& attributes) {
    static const std::map<std::string_view, double> kUnits = {{"micron", 0.001},  {"millimeter", 1},
                                                              {"centimeter", 10}, {"inch", 25.4},
                                                              {"foot", 304.8},    {"meter", 1000}};
    const auto unit = kUnits.find(attributes.find("unit").value_or("millimeter"));
    if (unit == kUnits.end()) return fail(MeshFileErrorCode::kSyntax, "an unknown unit");
    part_.unit_mm = unit->second;
  }

  void read_object(const Attributes& attributes) {
    const auto id = attributes.find("id");
    if (!id) return fail(MeshFileErrorCode::kSyntax, "an object has no id");
    const auto [place, added] = part_.objects.try_emplace(std::string(*id));
    if (!added) return fail(MeshFileErrorCode::kSyntax, "object " + place->first + " comes twice");
    count_object();
    object_ = &place->second;
    const auto type = attributes.find("type").value_or("model");
    object_->is_solid = type == "model" || type == "solidsupport";
  }

  void read_vertex(const Attributes& attributes) {
    std::array<double, 3> p{};
    for (std::size_t n = 0; n < 3; ++n) {
      constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
      const auto number = word_number<double>(attributes.find(kAxes[n]).value_or(""));
      if (!number) return fail(MeshFileErrorCode::kSyntax, "a vertex needs the numbers x, y and z");
      p[n] = *number;
    }
    if (!is_finite({p[0], p[1], p[2]}))
      return fail(MeshFileErrorCode::kNotFinite, "a coordinate is not finite");
    if (object_ == nullptr) return;
    if (++count_.vertices > 3 * count_.triangles_max) return fail_too_large("vertices for ");
    object_->mesh.vertices_mm.push_back({p[0], p[1], p[2]});
  }

  void read_triangle(const Attributes& attributes) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t n = 0; n < 3; ++n) {
      constexpr std::array<std::string_view, 3> kCorners{"v1", "v2", "v3"};
      const auto number = word_number<std::uint32_t>(attributes.find(kCorners[n]).value_or(""));
      if (!number)
        return fail(MeshFileErrorCode::kSyntax, "a triangle needs the numbers v1, v2 and v3");
      corners[n] = *number;
    }
    if (object_ == nullptr) return;
    const std::size_t count = object_->mesh.vertices_mm.size();
    for (const std::uint32_t corner : corners) {
      if (corner >= count)
        return fail(MeshFileErrorCode::kBadIndex, "vertex " + std::to_string(corner) +
                                                      " is out of range: the object has " +
                                                      std::to_string(count));
    }
    if (++count_.triangles > count_.triangles_max) return fail_too_large("");
    object_->mesh.triangles.push_back(corners);
  }

  void read_placed(const Attributes& attributes, std::vector<ThreemfPlaced>& list) {
    const auto id = attributes.find("objectid");
    if (!id) return fail(MeshFileErrorCode::kSyntax, "an item or component has no objectid");
    ThreemfPlaced placed{std::string(attributes.find(kPath).value_or("")), std::string(*id), {}};
    if (const auto text = attributes.find("transform")) {
      TextWords words(*text);
      for (double& m : placed.transform.m) {
        const auto number = word_number<double>(words.next());
        if (!number || !std::isfinite(*number))
          return fail(MeshFileErrorCode::kSyntax, "a transform needs twelve finite numbers");
        m = *number;
      }
    }
    list.push_back(std::move(placed));
    count_object();
  }

  std::string name_;
  ThreemfCount& count_;
  std::uint64_t given_ = 0;  ///< bytes passed to the parser
  std::uint64_t begun_ = 0;  ///< offset of the first byte that it has not handled yet
  ParserPointer parser_;
  ThreemfPart part_;
  ThreemfObject* object_ = nullptr;
  std::optional<MeshFileError> failure_;
};

void begin_relationship(void* target, const char*, const char** list) {
  const Attributes attributes(list);
  const auto type = attributes.find("Type"), place = attributes.find("Target");
  if (type && place && type->ends_with("/3dmodel")) *static_cast<std::string*>(target) = *place;
}

}  // namespace

ThreemfPart read_threemf_part(
    const std::string& name, ThreemfCount& count,
    const std::function<void(const std::function<void(std::string_view)>&)>& source) {
  PartReader reader(name, count);
  source([&reader](std::string_view text) { reader.take(text); });
  return reader.finish();
}

std::string threemf_model_part(std::string_view relationships) {
  std::string target;
  const ParserPointer parser(XML_ParserCreate(nullptr));
  XML_SetUserData(parser.get(), &target);
  XML_SetStartElementHandler(parser.get(), &begin_relationship);
  XML_Parse(parser.get(), relationships.data(), static_cast<int>(relationships.size()), 1);
  return target;
}

}  // namespace kerf
