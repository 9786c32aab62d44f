// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>

#include "server/http/api_call.h"
#include "server/session/session.h"

namespace kerf::net {

/// A solid and its hash.
struct HashedSolid {
  SolidSnapshot solid;
  StateHash hash;
  bool is_between_records = false;  ///< no replay gives it (Session::is_between_records)
};

/// Returns the current solid of a session. Computes its hash if it is unknown.
HashedSolid current_solid(Session& session);
/// Returns the solid of a call's session as of a record.
std::expected<HashedSolid, ApiResponse> solid_after(const ApiCall& call, std::uint64_t record);
/// Returns the solid as of the point named by the parameter `at`, or the current one.
std::expected<HashedSolid, ApiResponse> requested_block(const ApiCall& call);

}  // namespace kerf::net
