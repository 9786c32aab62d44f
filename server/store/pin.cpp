// SPDX-License-Identifier: Apache-2.0
#include "server/store/pin.h"

#include <array>
#include <bit>
#include <span>
#include <utility>

#include "server/store/crc32.h"

namespace kerf {
namespace {

constexpr int kPlaces = 6;  ///< coordinates of the place and the normal

/// Number, record, time, and the bits of the coordinates: columns 0 to 8 of a row.
std::array<std::int64_t, 3 + kPlaces> numbers_of(const Pin& pin) {
  const auto bits = [](double value) { return std::bit_cast<std::int64_t>(value); };
  return {std::int64_t{pin.number}, static_cast<std::int64_t>(pin.record),
          pin.created_ms,           bits(pin.at_mm.x),
          bits(pin.at_mm.y),        bits(pin.at_mm.z),
          bits(pin.normal.x),       bits(pin.normal.y),
          bits(pin.normal.z)};
}

std::int64_t checksum(const Pin& pin) {
  std::uint32_t crc = 0;
  for (const std::string* text : {&pin.text, &pin.author, &pin.person}) {
    crc = crc32(std::as_bytes(std::span(text->c_str(), text->size() + 1)), crc);
  }
  const auto numbers = numbers_of(pin);
  return crc32(std::as_bytes(std::span(numbers)), crc);
}

SqlResult<void> run_to_end(SqlStatement& statement) {
  if (auto row = statement.step(); !row) return std::unexpected(row.error());
  return {};
}

Pin pin_of(const SqlStatement& row) {
  const auto place = [&](int column) { return std::bit_cast<double>(row.integer(column)); };
  return {static_cast<std::uint32_t>(row.integer(0)),
          row.text(9),
          {place(3), place(4), place(5)},
          {place(6), place(7), place(8)},
          static_cast<std::uint64_t>(row.integer(1)),
          row.integer(2),
          row.text(10),
          row.text(11)};
}

}  // namespace

SqlResult<void> create_pin_table(SqlDatabase& database) {
  return database.execute(
      "CREATE TABLE IF NOT EXISTS pins(number INTEGER PRIMARY KEY, record INTEGER NOT NULL, "
      "created_ms INTEGER NOT NULL, x INTEGER NOT NULL, y INTEGER NOT NULL, z INTEGER NOT NULL, "
      "normal_x INTEGER NOT NULL, normal_y INTEGER NOT NULL, normal_z INTEGER NOT NULL, "
      "text TEXT NOT NULL, author TEXT NOT NULL, person TEXT NOT NULL, crc INTEGER NOT NULL)");
}

SqlResult<void> store_pin(SqlDatabase& database, const PinChange& change) {
  const Pin& pin = change.pin;
  if (change.is_removed) {
    auto statement = database.prepare("DELETE FROM pins WHERE number=?");
    if (!statement) return std::unexpected(statement.error());
    statement->bind(1, std::int64_t{pin.number});
    return run_to_end(*statement);
  }
  auto statement =
      database.prepare("INSERT OR REPLACE INTO pins VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?)");
  if (!statement) return std::unexpected(statement.error());
  int column = 0;
  for (const std::int64_t number : numbers_of(pin)) statement->bind(++column, number);
  for (const std::string* text : {&pin.text, &pin.author, &pin.person}) {
    statement->bind(++column, *text);
  }
  statement->bind(++column, checksum(pin));
  return run_to_end(*statement);
}

SqlResult<std::vector<Pin>> read_pins(SqlDatabase& database, std::uint64_t last) {
  std::vector<Pin> pins;
  const auto exists = database.has_table("pins");
  if (!exists) return std::unexpected(exists.error());
  if (!*exists) return pins;
  auto rows = database.prepare(
      "SELECT number, record, created_ms, x, y, z, normal_x, normal_y, normal_z, text, author, "
      "person, crc FROM pins WHERE record<=" +
      std::to_string(last) + " ORDER BY number");
  if (!rows) return std::unexpected(rows.error());
  for (;;) {
    const auto row = rows->step();
    if (!row) return std::unexpected(row.error());
    if (!*row) return pins;
    Pin pin = pin_of(*rows);
    if (rows->integer(12) == checksum(pin)) pins.push_back(std::move(pin));
  }
}

}  // namespace kerf
