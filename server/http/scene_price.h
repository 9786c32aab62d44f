// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "server/formats/scene.h"
#include "server/verify/price.h"

namespace kerf::net {

/// Describes a scene and the cost of a session of it as JSON; with `motions` that of a program.
std::string price_json(const Scene& scene, const Price& price,
                       std::optional<std::size_t> motions = std::nullopt);

}  // namespace kerf::net
