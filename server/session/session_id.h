// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace kerf {

/// True for a valid session id: 1 to 64 characters from a–z, 0–9, - and _, which are safe in file
/// names and URLs.
bool is_session_id(std::string_view id);
/// Derives a session id from a scene's name: lower case, other characters become '-'.
std::string id_from_name(std::string_view name);

}  // namespace kerf
