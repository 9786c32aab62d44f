// SPDX-License-Identifier: Apache-2.0
#include "server/targets/target_part.h"

#include <nlohmann/json.hpp>

namespace kerf::net {
namespace {

using Json = nlohmann::json;

Json stored_place(Vec3 v) { return {v.x, v.y, v.z}; }

Vec3 place_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

}  // namespace

std::string facts_text(const TargetFacts& facts) {
  const Json json = {{"name", facts.name},
                     {"tag", facts.tag},
                     {"triangles", facts.triangles},
                     {"min_mm", stored_place(facts.min_mm)},
                     {"max_mm", stored_place(facts.max_mm)},
                     {"shift_mm", stored_place(facts.shift_mm)},
                     {"unit_mm", facts.unit_mm},
                     {"author", facts.author},
                     {"fault", facts.fault}};
  return json.dump();
}

std::optional<TargetFacts> parse_facts(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    return TargetFacts{json.at("name").get<std::string>(),
                       json.at("tag").get<std::string>(),
                       json.at("triangles").get<std::size_t>(),
                       place_of(json.at("min_mm")),
                       place_of(json.at("max_mm")),
                       place_of(json.at("shift_mm")),
                       json.value("unit_mm", 1.0),
                       json.value("author", ""),
                       json.at("fault").get<std::string>()};
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace kerf::net
