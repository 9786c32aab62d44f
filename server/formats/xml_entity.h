// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace kerf {

/// Returns the entity of a character that is markup in the text and the attributes of XML, or "".
inline std::string_view xml_entity(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    default:
      return {};
  }
}

}  // namespace kerf
