// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/store/pin.h"

namespace kerf {

/// A pin as a JSON object, for the HTTP interface and for viewers.
std::string pin_json(const Pin& pin);

}  // namespace kerf
