// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_origin.h"

#include <cstdint>
#include <optional>

#include "server/store/byte_code.h"

namespace kerf {
namespace {

void put_text(ByteWriter& out, const std::string& text) {
  out.put(static_cast<std::uint32_t>(text.size()));
  out.put(std::as_bytes(std::span(text)));
}

std::string take_text(ByteReader& in) {
  const auto bytes = in.get_bytes(in.get<std::uint32_t>());
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

std::vector<std::byte> encode_origin(const JournalOrigin& origin) {
  ByteWriter out;
  out.put(static_cast<std::uint32_t>(2 + 2 * origin.files.size()));
  put_text(out, origin.session);
  put_text(out, origin.scene_json);
  for (const auto& [name, contents] : origin.files) {
    put_text(out, name);
    put_text(out, contents);
  }
  return out.take();
}

std::expected<JournalOrigin, std::string> read_origin(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  const auto texts = in.get<std::uint32_t>();
  JournalOrigin origin;
  origin.session = take_text(in);
  origin.scene_json = take_text(in);
  for (std::uint32_t n = 2; n + 1 < texts && !in.truncated(); n += 2) {
    const std::string name = take_text(in);
    origin.files[name] = take_text(in);
  }
  if (texts < 2 || texts % 2 != 0 || in.truncated() || !in.at_end()) {
    return std::unexpected("what the journal begins with is damaged");
  }
  return origin;
}

}  // namespace kerf
