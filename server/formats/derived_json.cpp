// SPDX-License-Identifier: Apache-2.0
#include "server/formats/derived_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace kerf {
namespace {

using Json = nlohmann::json;

Json list_of(const std::vector<FieldOrigin>& origins) {
  Json list = Json::array();
  for (const FieldOrigin& origin : origins)
    list.push_back({{"tool", origin.tool > 0 ? Json(origin.tool) : Json(nullptr)},
                    {"field", origin.field},
                    {"origin", to_string(origin.origin)},
                    {"source", origin.source}});
  return list;
}

/// The last bits of arc durations depend on the platform's sines.
double to_microseconds(double seconds) {
  constexpr double kPerS = 1e6;
  return std::round(seconds * kPerS) / kPerS;
}

/// Comments and names of a program may be in any encoding.
std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string provenance_json(const std::vector<FieldOrigin>& origins) {
  return text_of(list_of(origins));
}

std::string derived_json(const DerivedScene& derived, const std::string& questions) {
  Json json{{"scene", Json::parse(scene_json(derived.scene))},
            {"provenance", list_of(derived.origins)},
            {"notes", derived.notes},
            {"motions", derived.motions},
            {"programmed_s", to_microseconds(derived.programmed_s)},
            {"machine_s", to_microseconds(derived.machine_s)}};
  if (!questions.empty()) json["questions"] = Json::parse(questions);
  return text_of(json);
}

}  // namespace kerf
