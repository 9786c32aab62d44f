// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace kerf::net {

/// The description of the HTTP interface for programs (OpenAPI 3.1): openapi.json, which the build
/// compiles in. A test compares it with the route table.
std::string_view openapi_text();

}  // namespace kerf::net
