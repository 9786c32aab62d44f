// SPDX-License-Identifier: Apache-2.0
#include "server/pins/pin.h"

#include <bit>
#include <nlohmann/json.hpp>

namespace kerf {

ListRow to_row(const Pin& pin) {
  const auto bits = [](double value) { return std::bit_cast<std::int64_t>(value); };
  return {std::int64_t{pin.number},
          static_cast<std::int64_t>(pin.record),
          pin.created_ms,
          bits(pin.at_mm.x),
          bits(pin.at_mm.y),
          bits(pin.at_mm.z),
          bits(pin.normal.x),
          bits(pin.normal.y),
          bits(pin.normal.z),
          pin.text,
          pin.author,
          pin.person};
}

Pin pin_of(const ListRow& row) {
  const auto integer = [&](std::size_t column) { return std::get<std::int64_t>(row.at(column)); };
  const auto number = [&](std::size_t column) { return std::bit_cast<double>(integer(column)); };
  const auto text = [&](std::size_t column) { return std::get<std::string>(row.at(column)); };
  return {static_cast<std::uint32_t>(integer(0)),
          text(9),
          {number(3), number(4), number(5)},
          {number(6), number(7), number(8)},
          static_cast<std::uint64_t>(integer(1)),
          integer(2),
          text(10),
          text(11)};
}

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
