// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/matter_store.h"

namespace kerf::net {

/// Returns the routes of participants, invitations and reserved regions.
HttpMatter http_people();

}  // namespace kerf::net
