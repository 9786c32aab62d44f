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

/// Rules for reading untrusted JSON.
struct JsonRules {
  int depth_max = 32;                     ///< nesting of lists and objects; the outermost is 1
  bool drops_deeper = false;              ///< drop deeper values instead of failing
  bool takes_repeated_keys = false;       ///< the last of equal keys counts, instead of an error
  std::size_t values_max = SIZE_MAX;      ///< in the document, lists and objects included
  std::function<bool()> is_stopped = {};  ///< polled at intervals: whether to stop
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
  std::size_t byte = 0;  ///< kSyntax: offset of the error, from 0
  std::string key = {};  ///< of kRepeatedKey
};

/// A document. Points to a nlohmann::json, whose header stays out of this one.
using JsonDocument = std::shared_ptr<void>;

/// Parses JSON in time linear in the length of any text. The library's own parser with a callback
/// walks through the parent at each end of an object.
std::expected<JsonDocument, JsonFault> parse_bounded_json(std::string_view text,
                                                          const JsonRules& rules);

}  // namespace kerf
