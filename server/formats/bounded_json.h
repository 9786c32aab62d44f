// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace kerf {

/// How JSON of strangers is read.
struct JsonRules {
  int depth_max = 32;                 ///< of lists and objects in each other; the outermost is 1
  bool drops_deeper = false;          ///< deeper values are left out; otherwise they are an error
  bool takes_repeated_keys = false;   ///< the last one counts; otherwise it is an error
  std::size_t values_max = SIZE_MAX;  ///< of the document, lists and objects included
  std::function<bool()> is_stopped = {};  ///< asked now and then: whether to end
};

enum class JsonFaultKind {
  kSyntax,       ///< no valid JSON
  kRange,        ///< a number beyond the range of a double
  kTooDeep,      ///< nested deeper than the limit
  kTooMany,      ///< more values than the limit
  kRepeatedKey,  ///< a key comes twice in one object
  kStopped       ///< a stop was requested
};
struct JsonFault {
  JsonFaultKind kind = JsonFaultKind::kSyntax;
  std::size_t byte = 0;  ///< of kSyntax: at which the text is wrong, from 0
  std::string key = {};  ///< of kRepeatedKey
};

/// A document: points to a nlohmann::json, which the header keeps out of those that include it.
using JsonDocument = std::shared_ptr<void>;

/// Parses JSON in time that grows with the length of the text, whatever it holds: the library's
/// parser with a callback walks through the parent at each end of an object.
std::expected<JsonDocument, JsonFault> parse_bounded_json(std::string_view text,
                                                          const JsonRules& rules);

}  // namespace kerf
