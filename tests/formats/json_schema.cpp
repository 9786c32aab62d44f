// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/json_schema.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace kerf::test {
namespace {

using Json = nlohmann::json;

bool has_type(const Json& value, const Json& type) {
  if (type.is_array()) {
    return std::ranges::any_of(type, [&](const Json& one) { return has_type(value, one); });
  }
  if (type == "null") return value.is_null();
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "number") return value.is_number();
  if (type == "integer")
    return value.is_number() && std::trunc(value.get<double>()) == value.get<double>();
  throw std::invalid_argument("type " + type.dump());
}

// Whether a number violates a limit; other values do not.
bool beyond(const std::string& keyword, const Json& limit, const Json& value) {
  if (!value.is_number()) return false;
  const double number = value.get<double>(), edge = limit.get<double>();
  if (keyword == "minimum") return number < edge;
  if (keyword == "maximum") return number > edge;
  return number <= edge;  // exclusiveMinimum
}

}  // namespace

std::vector<SchemaFault> JsonSchema::faults(const Json& value) const {
  std::vector<SchemaFault> found;
  check(root_, value, "", found);
  return found;
}

const Json& JsonSchema::resolved(const Json& schema) const {
  if (!schema.contains("$ref")) return schema;
  return root_.at(Json::json_pointer(schema["$ref"].get<std::string>().substr(1)));
}

void JsonSchema::check(const Json& reference, const Json& value, const std::string& path,
                       std::vector<SchemaFault>& found) const {
  const Json& schema = resolved(reference);
  static const std::set<std::string> kNotes = {"$schema", "title",       "description",
                                               "default", "definitions", "$ref"};
  static const std::set<std::string> kOfObjects = {"required", "properties",
                                                   "additionalProperties"};
  for (const auto& [keyword, rule] : schema.items()) {
    const auto fault = [&, &name = keyword](bool violated) {
      if (violated) found.push_back({path, name});
    };
    if (keyword == "type") {
      fault(!has_type(value, rule));
    } else if (keyword == "const") {
      fault(value != rule);
    } else if (keyword == "enum") {
      fault(std::ranges::find(rule, value) == rule.end());
    } else if (keyword == "minimum" || keyword == "maximum" || keyword == "exclusiveMinimum") {
      fault(beyond(keyword, rule, value));
    } else if (keyword == "minItems") {
      fault(value.is_array() && value.size() < rule.get<std::size_t>());
    } else if (keyword == "maxItems") {
      fault(value.is_array() && value.size() > rule.get<std::size_t>());
    } else if (keyword == "items") {
      for (std::size_t n = 0; value.is_array() && n < value.size(); ++n)
        check(rule, value[n], path + "/" + std::to_string(n), found);
    } else if (keyword == "oneOf") {
      check_one_of(rule, value, path, found);
    } else if (keyword == "anyOf") {
      fault(std::ranges::none_of(rule, [&](const Json& option) {
        std::vector<SchemaFault> faults;
        check(option, value, path, faults);
        return faults.empty();
      }));
    } else if (!kNotes.contains(keyword) && !kOfObjects.contains(keyword)) {
      throw std::invalid_argument("keyword " + keyword);
    }
  }
  if (value.is_object()) check_object(schema, value, path, found);
}

void JsonSchema::check_object(const Json& schema, const Json& value, const std::string& path,
                              std::vector<SchemaFault>& found) const {
  for (const Json& name : schema.value("required", Json::array()))
    if (!value.contains(name)) found.push_back({path, "required"});
  if (!schema.contains("properties")) return;
  for (const auto& [name, member] : value.items()) {
    const std::string place = path + "/" + name;
    if (schema["properties"].contains(name)) {
      check(schema["properties"][name], member, place, found);
    } else if (schema.value("additionalProperties", Json(true)) == false) {
      found.push_back({place, "additionalProperties"});
    }
  }
}

bool JsonSchema::fits_kind(const Json& reference, const Json& value) const {
  const Json& option = resolved(reference);
  if (option.contains("type") && !has_type(value, option["type"])) return false;
  if (!option.contains("properties")) return true;
  for (const auto& [name, rule] : option["properties"].items()) {
    const Json needed = option.value("required", Json::array());
    const bool required = std::find(needed.begin(), needed.end(), name) != needed.end();
    if (!rule.contains("const") && !(rule.contains("enum") && required)) continue;
    std::vector<SchemaFault> faults;
    if (value.contains(name)) check(rule, value[name], "", faults);
    if (!faults.empty()) return false;
  }
  return true;
}

void JsonSchema::check_one_of(const Json& options, const Json& value, const std::string& path,
                              std::vector<SchemaFault>& found) const {
  std::vector<SchemaFault> best;
  std::size_t valid = 0;
  bool any = false;
  for (const Json& option : options) {
    std::vector<SchemaFault> faults;
    check(option, value, path, faults);
    if (faults.empty()) ++valid;
    if (!fits_kind(option, value)) continue;
    if (!any || faults.size() < best.size()) best = faults;
    any = true;
  }
  if (valid == 1) return;
  if (valid > 1 || !any) best = {{path, "oneOf"}};
  found.insert(found.end(), best.begin(), best.end());
}

}  // namespace kerf::test
