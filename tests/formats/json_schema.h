// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kerf::test {

/// A place at which a value violates a schema, and the keyword that it violates.
struct SchemaFault {
  std::string path;  ///< JSON pointer
  std::string keyword;
};

/// Validates values against a JSON Schema (draft 7) that uses a part of its keywords; another
/// keyword throws std::invalid_argument, so that nothing is ignored.
class JsonSchema {
 public:
  explicit JsonSchema(nlohmann::json schema) : root_(std::move(schema)) {}

  /// Returns the faults of a value, none if it is valid. Of alternatives (oneOf) that name a kind
  /// in a const or enum, those of the one whose kind the value has.
  std::vector<SchemaFault> faults(const nlohmann::json& value) const;

 private:
  using Json = nlohmann::json;
  void check(const Json& schema, const Json& value, const std::string& path,
             std::vector<SchemaFault>& found) const;
  void check_object(const Json& schema, const Json& value, const std::string& path,
                    std::vector<SchemaFault>& found) const;
  void check_one_of(const Json& options, const Json& value, const std::string& path,
                    std::vector<SchemaFault>& found) const;
  bool fits_kind(const Json& option, const Json& value) const;
  const Json& resolved(const Json& schema) const;

  Json root_;
};

}  // namespace kerf::test
