// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kerf::test {

/// A position at which a value violates a schema, and the violated keyword.
struct SchemaFault {
  std::string path;  ///< JSON pointer
  std::string keyword;
};

/// Validates values against a JSON Schema (draft 7) with a subset of its keywords. Another keyword
/// throws std::invalid_argument, so that none is ignored silently.
class JsonSchema {
 public:
  explicit JsonSchema(nlohmann::json schema) : root_(std::move(schema)) {}

  /// Returns the faults of a value. Empty if it is valid. If alternatives (oneOf) name a kind in a
  /// const or enum, returns the faults against the alternative with the value's kind.
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
