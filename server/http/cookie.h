// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace kerf::net {

/// Returns a Set-Cookie header that keeps a pass for the pages of one session. Scripts cannot read
/// it (HttpOnly), other sites cannot send it (SameSite=Strict), and if received over TLS it is only
/// sent over TLS (Secure).
std::string pass_cookie(std::string_view session, std::string_view token, std::int64_t lifetime_s,
                        bool is_secure);
/// Returns the pass in a Cookie header; empty if there is none.
std::string pass_of_cookies(std::string_view header);
/// Returns the token of an "Authorization: Bearer TOKEN" header; empty for any other header.
std::string bearer_token(std::string_view header);

}  // namespace kerf::net
