// SPDX-License-Identifier: Apache-2.0
#include "server/session/pin_json.h"

#include <nlohmann/json.hpp>

namespace kerf {

std::string pin_json(const Pin& pin) {
  const nlohmann::json json = {{"pin", pin.number},
                               {"text", pin.text},
                               {"at_mm", {pin.at_mm.x, pin.at_mm.y, pin.at_mm.z}},
                               {"normal", {pin.normal.x, pin.normal.y, pin.normal.z}},
                               {"record", pin.record},
                               {"created_ms", pin.created_ms},
                               {"author", pin.author}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace kerf
