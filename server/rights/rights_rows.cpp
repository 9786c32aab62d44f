// SPDX-License-Identifier: Apache-2.0
#include "server/rights/rights_rows.h"

#include <cstdint>
#include <cstring>
#include <string_view>

#include "server/store/byte_code.h"

namespace kerf {
namespace {

/// Of the bytes of both kinds.
constexpr std::uint8_t kLayout = 1;

void put_text(ByteWriter& out, std::string_view text) {
  out.put(static_cast<std::uint32_t>(text.size()));
  out.put(std::as_bytes(std::span(text)));
}

std::string get_text(ByteReader& in) {
  const auto bytes = in.get_bytes(in.get<std::uint32_t>());
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void put_number(ByteWriter& out, std::int64_t number) {
  out.put(static_cast<std::uint64_t>(number));
}

std::int64_t get_number(ByteReader& in) {
  return static_cast<std::int64_t>(in.get<std::uint64_t>());
}

bool is_read(const ByteReader& in) { return !in.truncated() && in.at_end(); }

}  // namespace

AttachmentChange stored(const Grant& grant) {
  ByteWriter out;
  out.put(kLayout);
  put_text(out, to_string(grant.role));
  for (const std::string* text : {&grant.invitation, &grant.name, &grant.color}) {
    put_text(out, *text);
  }
  for (const std::int64_t number :
       {grant.created_s, grant.expires_s, std::int64_t{grant.muted}, grant.uses, grant.used}) {
    put_number(out, number);
  }
  out.put(std::span<const std::byte>(grant.hash));
  return {kGrantKind, grant.id, out.take()};
}

std::optional<Grant> grant_of(const Attachment& attachment, const std::string& session) {
  ByteReader in(attachment.bytes);
  if (attachment.kind != kGrantKind || in.get<std::uint8_t>() != kLayout) return std::nullopt;
  Grant grant;
  grant.id = attachment.name;
  grant.session = session;
  const auto role = parse_role(get_text(in));
  grant.invitation = get_text(in);
  grant.name = get_text(in);
  grant.color = get_text(in);
  grant.created_s = get_number(in);
  grant.expires_s = get_number(in);
  grant.muted = get_number(in) != 0;
  grant.uses = get_number(in);
  grant.used = get_number(in);
  const auto hash = in.get_bytes(grant.hash.size());
  if (!role || !is_read(in)) return std::nullopt;
  grant.role = *role;
  std::memcpy(grant.hash.data(), hash.data(), hash.size());
  return grant;
}

AttachmentChange stored(const Region& region) {
  ByteWriter out;
  out.put(kLayout);
  out.put(region.id);
  out.put(region.min_mm);
  out.put(region.max_mm);
  out.put(region.participant);
  put_text(out, region.person);
  return {kRegionKind, std::to_string(region.id), out.take()};
}

std::optional<Region> region_of(const Attachment& attachment) {
  ByteReader in(attachment.bytes);
  if (attachment.kind != kRegionKind || in.get<std::uint8_t>() != kLayout) return std::nullopt;
  Region region;
  region.id = in.get<std::uint32_t>();
  region.min_mm = in.get_vec3();
  region.max_mm = in.get_vec3();
  region.participant = in.get<std::uint32_t>();
  region.person = get_text(in);
  if (!is_read(in)) return std::nullopt;
  return region;
}

}  // namespace kerf
