// SPDX-License-Identifier: Apache-2.0
#include "server/session/session_id.h"

#include <algorithm>
#include <cctype>

#include "server/wire/limits.h"

namespace kerf {

bool is_session_id(std::string_view id) {
  return !id.empty() && id.size() <= wire::kMaxSessionIdBytes &&
         std::ranges::all_of(id, [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
         });
}

std::string id_from_name(std::string_view name) {
  std::string id;
  for (const char c : name.substr(0, wire::kMaxSessionIdBytes - 8)) {
    const auto lower = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    id.push_back(is_session_id(std::string_view(&lower, 1)) ? lower : '-');
  }
  return id.empty() ? "session" : id;
}

}  // namespace kerf
