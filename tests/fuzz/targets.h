// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace kerf::fuzz {

using Bytes = std::span<const std::byte>;

/// Passes bytes of a peer or a file to the code that reads them. Aborts if a property is violated.
struct Target {
  std::string_view name;
  void (*run)(Bytes input);
};
std::span<const Target> targets();

inline std::string_view text_of(Bytes input) {
  return {reinterpret_cast<const char*>(input.data()), input.size()};
}
/// Aborts the program if a property does not hold. A fuzzer reports this with the input.
void require(bool holds, const char* property);

void read_wire(Bytes input);
void read_columns(Bytes input);
void read_control(Bytes input);
void converse(Bytes input);
void read_gcode(Bytes input);
void read_apt(Bytes input);
void read_tables(Bytes input);
void read_scene(Bytes input);
void read_mesh(Bytes input);
void read_batch(Bytes input);
void read_journal(Bytes input);
void read_snapshot(Bytes input);
void read_tile(Bytes input);
void read_request(Bytes input);

}  // namespace kerf::fuzz
