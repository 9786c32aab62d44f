// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/change_frame.h"

#include <string_view>
#include <utility>

#include "server/store/byte_code.h"
#include "server/store/crc32.h"

namespace kerf {
namespace {

constexpr std::uint32_t kMagic = 0x4346524BU;  // "KRFC"
constexpr std::uint32_t kVersion = 1;
constexpr std::string_view kStreamPrefix = "KERF_JOURNAL_";

void put(ByteWriter& out, const CopyPosition& position) {
  out.put(position.record);
  out.put(position.hash_after);
  out.put(position.scene_crc);
  out.put(position.record_crc);
}

CopyPosition get_position(ByteReader& in) {
  CopyPosition position;
  position.record = in.get<std::uint64_t>();
  position.hash_after = in.get<std::uint64_t>();
  position.scene_crc = in.get<std::uint32_t>();
  position.record_crc = in.get<std::uint32_t>();
  return position;
}

}  // namespace

std::vector<std::byte> encode_frame(const FrameHead& head, std::span<const std::byte> rows) {
  ByteWriter body;
  body.put(head.epoch);
  body.put(head.writer);
  body.put(head.change);
  body.put(head.part);
  body.put(head.parts);
  body.put(static_cast<std::uint8_t>(head.is_whole));
  put(body, head.before);
  put(body, head.after);
  body.put(rows);
  const auto bytes = body.take();
  ByteWriter out;
  out.reserve(bytes.size() + 12);
  out.put(kMagic);
  out.put(kVersion);
  out.put(crc32(bytes));
  out.put(std::span<const std::byte>(bytes));
  return out.take();
}

std::optional<Frame> decode_frame(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  const auto magic = in.get<std::uint32_t>();
  const auto version = in.get<std::uint32_t>();
  const auto crc = in.get<std::uint32_t>();
  if (in.truncated() || magic != kMagic || version != kVersion || crc != crc32(bytes.subspan(12))) {
    return std::nullopt;
  }
  Frame frame;
  FrameHead& head = frame.head;
  head.epoch = in.get<std::uint32_t>();
  head.writer = in.get<std::uint64_t>();
  head.change = in.get<std::uint64_t>();
  head.part = in.get<std::uint32_t>();
  head.parts = in.get<std::uint32_t>();
  head.is_whole = in.get<std::uint8_t>() != 0;
  head.before = get_position(in);
  head.after = get_position(in);
  if (in.truncated() || head.part >= head.parts) return std::nullopt;
  constexpr std::size_t kHead = 12 + 29 + 2 * 24;
  frame.rows = bytes.subspan(kHead);
  return frame;
}

std::string copy_stream(const std::string& session) { return std::string(kStreamPrefix) + session; }

std::string copy_subject(const std::string& session) { return "kerf.journal." + session; }

std::optional<std::string> session_of_stream(const std::string& stream) {
  if (!stream.starts_with(kStreamPrefix)) return std::nullopt;
  return stream.substr(kStreamPrefix.size());
}

}  // namespace kerf
