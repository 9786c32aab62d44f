// SPDX-License-Identifier: Apache-2.0
#include "server/rights/rights_rows.h"

#include <cstdint>
#include <cstring>

#include "server/store/byte_code.h"

namespace kerf {
namespace {

/// Version of the bytes of both kinds.
constexpr std::uint8_t kLayout = 1;

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
  out.put_text(to_string(grant.role));
  for (const std::string* text : {&grant.invitation, &grant.name, &grant.color}) {
    out.put_text(*text);
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
  const auto role = parse_role(in.get_text());
  grant.invitation = in.get_text();
  grant.name = in.get_text();
  grant.color = in.get_text();
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
  out.put_text(region.person);
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
  region.person = in.get_text();
  if (!is_read(in)) return std::nullopt;
  return region;
}

}  // namespace kerf
