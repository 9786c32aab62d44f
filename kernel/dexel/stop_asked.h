// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace kerf {

/// Returns whether work shall end early. The working thread asks now and then. Empty: never.
using StopAsked = std::function<bool()>;

}  // namespace kerf
