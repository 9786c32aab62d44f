// SPDX-License-Identifier: Apache-2.0
#include "server/formats/scene_fields.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace kerf {
namespace {

using Json = nlohmann::json;

const Json& node(const void* json) { return *static_cast<const Json*>(json); }

std::string json_text(double value) { return Json(value).dump(); }

}  // namespace

bool SceneValue::is_list() const { return node(json_).is_array(); }
bool SceneValue::is_object() const { return node(json_).is_object(); }
bool SceneValue::is_text() const { return node(json_).is_string(); }

double SceneValue::number(double above, double most) const {
  if (!node(json_).is_number()) reject("must be a number");
  const double number = node(json_).get<double>();
  if (!std::isfinite(number)) reject("must be a finite number");
  if (number <= above || number > most) {
    reject("is " + json_text(number) + "; it must be above " + json_text(above) +
           (most < kInfinity ? " and at most " + json_text(most) : ""));
  }
  return number;
}

std::string SceneValue::text() const {
  if (!is_text()) reject("must be a string");
  return node(json_).get<std::string>();
}

bool SceneValue::flag() const {
  if (!node(json_).is_boolean()) reject("must be true or false");
  return node(json_).get<bool>();
}

std::vector<SceneValue> SceneValue::items(std::size_t most) const {
  if (!is_list()) reject("must be a list […]");
  if (node(json_).size() > most) {
    reject("has " + std::to_string(node(json_).size()) + " items; the limit is " +
           std::to_string(most));
  }
  std::vector<SceneValue> items;
  items.reserve(node(json_).size());
  for (std::size_t i = 0; i < node(json_).size(); ++i) {
    items.emplace_back(&node(json_)[i], path_ + "[" + std::to_string(i) + "]");
  }
  return items;
}

void SceneValue::read_numbers(std::span<double> into) const {
  if (!is_list() || node(json_).size() != into.size()) {
    reject("must be a list of " + std::to_string(into.size()) + " numbers");
  }
  const auto values = items();
  for (std::size_t i = 0; i < into.size(); ++i) into[i] = values[i].number();
}

SceneFields::SceneFields(SceneValue object) : object_(std::move(object)) {
  if (!object_.is_object()) object_.reject("must be an object {…}");
}

std::optional<SceneValue> SceneFields::find(const std::string& field) {
  read_.insert(field);
  const Json& json = node(object_.json_);
  const auto it = json.find(field);
  if (it == json.end()) return std::nullopt;
  return SceneValue(&*it, path_of(field));
}

SceneValue SceneFields::required(const std::string& field) {
  auto value = find(field);
  if (!value) reject(field, "is missing");
  return *std::move(value);
}

double SceneFields::not_negative(const std::string& field, double standard) {
  const auto value = find(field);
  if (!value) return standard;
  const double number = value->number();
  if (number < 0) reject(field, "is " + json_text(number) + "; it must not be negative");
  return number;
}

void SceneFields::reject_unknown() const {
  for (const auto& [field, value] : node(object_.json_).items()) {
    if (!read_.contains(field)) reject(field, "is not a field of a scene");
  }
}

}  // namespace kerf
