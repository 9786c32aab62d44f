// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_origin.h"

#include <cstdint>
#include <optional>

#include "server/store/byte_code.h"

namespace kerf {

std::vector<std::byte> encode_origin(const JournalOrigin& origin) {
  ByteWriter out;
  out.put(static_cast<std::uint32_t>(2 + 2 * origin.files.size()));
  out.put_text(origin.session);
  out.put_text(origin.scene_json);
  for (const auto& [name, contents] : origin.files) {
    out.put_text(name);
    out.put_text(contents);
  }
  return out.take();
}

std::expected<JournalOrigin, std::string> read_origin(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  const auto texts = in.get<std::uint32_t>();
  JournalOrigin origin;
  origin.session = in.get_text();
  origin.scene_json = in.get_text();
  for (std::uint32_t n = 2; n + 1 < texts && !in.truncated(); n += 2) {
    const std::string name = in.get_text();
    origin.files[name] = in.get_text();
  }
  if (texts < 2 || texts % 2 != 0 || in.truncated() || !in.at_end()) {
    return std::unexpected("what the journal begins with is damaged");
  }
  return origin;
}

}  // namespace kerf
