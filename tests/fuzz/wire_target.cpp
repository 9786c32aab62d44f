// SPDX-License-Identifier: Apache-2.0
// Binary frames, the columns of stock frames, JSON control messages.
#include <algorithm>
#include <vector>

#include "server/conversation/control_json.h"
#include "server/convert/stock_columns.h"
#include "server/wire/codec.h"
#include "tests/fuzz/targets.h"

namespace kerf::fuzz {

/// A decoded batch of motions is encoded to the same bytes, which checks all its fields.
void read_wire(Bytes input) {
  const auto message = wire::decode(input);
  if (!message) return;
  const auto* batch = std::get_if<wire::MotionBatch>(&message->body);
  const std::size_t header = message->header.header_bytes;
  if (batch == nullptr) return;
  std::vector<std::byte> bytes;
  wire::append(bytes, message->header.stamp, *batch);
  const auto again = wire::decode(bytes);
  require(again.has_value(), "an encoded batch can be decoded");
  require(std::get<wire::MotionBatch>(again->body).count == batch->count, "with all its samples");
  require(bytes.size() - 32 == input.size() - header, "in as many bytes");
}

void read_columns(Bytes input) { (void)decode_columns(input); }

void read_control(Bytes input) { (void)net::parse_control(text_of(input)); }

}  // namespace kerf::fuzz
