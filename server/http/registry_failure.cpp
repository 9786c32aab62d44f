// SPDX-License-Identifier: Apache-2.0
#include "server/http/registry_failure.h"

#include "server/http/responses.h"

namespace kerf::net {
namespace {

unsigned http_status(RegistryErrorCode code) {
  switch (code) {
    case RegistryErrorCode::kBadId:
    case RegistryErrorCode::kBadScene:
      return 400;
    case RegistryErrorCode::kExists:
      return 409;
    case RegistryErrorCode::kUnknown:
      return 404;
    case RegistryErrorCode::kTooMany:
    case RegistryErrorCode::kDiskFails:
      return 503;
    case RegistryErrorCode::kJournal:
      return 500;
    case RegistryErrorCode::kDiskFull:
    case RegistryErrorCode::kNotClosed:
      return 507;
    case RegistryErrorCode::kNoLease:
    case RegistryErrorCode::kStopped:
      return 503;
  }
  return 500;
}

}  // namespace

ApiResponse registry_failure(const RegistryError& error) {
  if (error.code == RegistryErrorCode::kStopped) return stopped();
  return error_response(http_status(error.code), to_string(error.code), error.reason, error.path);
}

}  // namespace kerf::net
