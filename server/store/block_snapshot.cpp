// SPDX-License-Identifier: Apache-2.0
#include "server/store/block_snapshot.h"

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kernel/dexel/dexel_field.h"
#include "kernel/kernel_version.h"
#include "kernel/sculpture.h"
#include "kernel/sculpture_check.h"
#include "server/store/byte_code.h"
#include "server/store/chunk_file.h"
#include "server/store/journal_record.h"
#include "server/store/tile_code.h"

namespace kerf {
namespace {

/// Size at which a chunk of tiles is closed after the current tile.
constexpr std::size_t kTileChunkBytes = std::size_t{1} << 20;
constexpr std::uint32_t kCountMax = 1U << 20;  ///< of tools, poses and users

std::unexpected<SnapshotError> damaged(const std::string& reason) {
  return std::unexpected(SnapshotError{false, reason});
}

void put_text(ByteWriter& out, std::span<const std::byte> bytes) {
  out.put(static_cast<std::uint32_t>(bytes.size()));
  out.put(bytes);
}
std::span<const std::byte> get_text(ByteReader& in) {
  return in.get_bytes(in.get<std::uint32_t>());
}

std::vector<std::byte> encode_head(const SnapshotHead& head, const SculptureState& state) {
  ByteWriter out;
  out.put(static_cast<std::uint64_t>(kKernelVersion));
  put_text(out, std::as_bytes(std::span(head.session)));
  for (const std::uint64_t number :
       {head.sequence, head.hash, head.mark, state.motions, state.sub_motions}) {
    out.put(number);
  }
  out.put(state.removed_mm3);
  out.put(state.imprint_mm3);
  out.put(static_cast<std::uint32_t>(state.solid.fields.size()));
  out.put(static_cast<std::uint32_t>(state.tools.size()));
  for (const auto& [id, tool] : state.tools) put_text(out, encode_command(DefineTool{id, tool}));
  out.put(static_cast<std::uint32_t>(state.last_poses.size()));
  for (const auto& [id, pose] : state.last_poses) {
    out.put(id);
    out.put(pose);
  }
  out.put(static_cast<std::uint32_t>(state.users.size()));
  for (const ToolUser& user : state.users) {
    out.put(user.tool);
    out.put(user.at);
  }
  return out.take();
}

/// Reads the tools, poses and users. Returns false if they are malformed.
bool decode_users(ByteReader& in, SculptureState& state) {
  const auto tools = in.get<std::uint32_t>();
  for (std::uint32_t n = 0; n < tools && !in.truncated(); ++n) {
    const auto command = decode_command(get_text(in));
    const auto* define = command ? std::get_if<DefineTool>(&*command) : nullptr;
    if (define == nullptr) return false;
    // Same construction as in Sculpture::apply.
    auto tool = make_tool(define->tool.pieces, define->tool.non_cutting);
    if (!tool) return false;
    state.tools[define->id] = *std::move(tool);
  }
  const auto poses = in.get<std::uint32_t>();
  for (std::uint32_t n = 0; n < poses && !in.truncated(); ++n) {
    const auto id = in.get<std::uint32_t>();
    state.last_poses[id] = in.get_pose();
  }
  const auto users = in.get<std::uint32_t>();
  for (std::uint32_t n = 0; n < users && !in.truncated(); ++n) {
    const auto tool = in.get<std::uint32_t>();
    state.users.push_back({tool, in.get_pose()});
  }
  return tools <= kCountMax && poses <= kCountMax && users <= kCountMax && !in.truncated() &&
         in.at_end();
}

/// Reads the part of the head that describes the block and leaves the rest in `in`.
SnapshotHead decode_head(ByteReader& in, SculptureState& state, std::uint32_t& fields) {
  SnapshotHead head;
  head.kernel_version = static_cast<std::int64_t>(in.get<std::uint64_t>());
  const auto session = get_text(in);
  head.session.assign(reinterpret_cast<const char*>(session.data()), session.size());
  head.sequence = in.get<std::uint64_t>();
  head.hash = in.get<std::uint64_t>();
  head.mark = in.get<std::uint64_t>();
  head.motions = state.motions = in.get<std::uint64_t>();
  state.sub_motions = in.get<std::uint64_t>();
  state.removed_mm3 = in.get_double();
  state.imprint_mm3 = in.get_double();
  fields = in.get<std::uint32_t>();
  return head;
}

/// Appends the tiles of all fields, in chunks of one field each.
void write_tiles(ChunkWriter& out, const SolidSnapshot& solid) {
  std::uint64_t tiles = 0;
  for (std::size_t n = 0; n < solid.fields.size(); ++n) {
    std::vector<std::byte> chunk;
    const auto flush = [&] {
      if (!chunk.empty()) out.write(chunk);
      chunk.clear();
    };
    solid.fields[n].for_each_touched([&](TileIndex at, const DexelTile& tile) {
      ByteWriter place;
      for (const auto number : {static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(at.x),
                                static_cast<std::uint32_t>(at.y)}) {
        place.put(number);
      }
      const auto bytes = place.take();
      chunk.insert(chunk.end(), bytes.begin(), bytes.end());
      encode_tile(tile, chunk);
      ++tiles;
      if (chunk.size() >= kTileChunkBytes) flush();
    });
    flush();
  }
  ByteWriter end;
  end.put(tiles);
  out.write(end.take());
}

/// Puts the tiles of one chunk into the directories of the fields. Returns their number, nullopt if
/// one is malformed.
std::optional<std::uint64_t> read_tiles(std::span<const std::byte> chunk,
                                        std::span<const DexelField* const> fields,
                                        std::vector<TileDirectory>& directories) {
  ByteReader in(chunk);
  std::uint64_t tiles = 0;
  while (!in.at_end()) {
    const auto field = in.get<std::uint32_t>();
    const auto x = static_cast<std::int32_t>(in.get<std::uint32_t>());
    const TileIndex at{x, static_cast<std::int32_t>(in.get<std::uint32_t>())};
    if (in.truncated() || field >= fields.size()) return std::nullopt;
    const DexelGrid& grid = fields[field]->grid();
    if (!grid.has(at)) return std::nullopt;
    auto tile = decode_tile(in, grid.height_quanta, fields[field]->keeps_normals());
    if (!tile) return std::nullopt;
    directories[field].slot(at, 0) = std::move(tile);
    ++tiles;
  }
  return tiles;
}

std::expected<SolidSnapshot, SnapshotError> read_solid(ChunkReader& in, const Sculpture& like) {
  std::vector<const DexelField*> fields;
  std::vector<TileDirectory> directories;
  for (const RayAxis axis : axes_of(like.settings().rays)) {
    fields.push_back(like.field(axis));
    const DexelGrid& grid = fields.back()->grid();
    directories.emplace_back(grid.tiles_x(), grid.tiles_y());
  }
  std::uint64_t tiles = 0;
  for (;;) {
    const auto chunk = in.next();
    if (!chunk) return damaged(chunk.error());
    if (chunk->size() == sizeof(std::uint64_t)) {  // last chunk
      if (ByteReader(*chunk).get<std::uint64_t>() != tiles) return damaged("tiles are missing");
      break;
    }
    const auto read = read_tiles(*chunk, fields, directories);
    if (!read) return damaged("a tile is malformed");
    tiles += *read;
  }
  if (!in.at_end()) return damaged("bytes follow its end");
  SolidSnapshot solid;
  for (std::size_t n = 0; n < fields.size(); ++n) {
    const DexelGrid& grid = fields[n]->grid();
    // Untouched tiles are not stored: the restored block knows them.
    solid.fields.emplace_back(grid, fields[n]->stock(), fields[n]->shares(),
                              std::move(directories[n]),
                              TileDirectory(grid.tiles_x(), grid.tiles_y()));
  }
  return solid;
}

/// Returns the chunk with the head, valid until the next one is read.
std::expected<std::span<const std::byte>, SnapshotError> first_chunk(
    const std::filesystem::path& file, ChunkReader& in) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    return std::unexpected(SnapshotError{true, "there is no snapshot"});
  }
  const auto chunk = in.next();
  if (!chunk) return damaged(chunk.error());
  return *chunk;
}

/// Reads the rest of a snapshot after its first chunk.
std::expected<BlockSnapshot, SnapshotError> read_block(std::span<const std::byte> first,
                                                       ChunkReader& in, const Sculpture& like,
                                                       bool of_any_kernel) {
  BlockSnapshot snapshot;
  ByteReader bytes(first);
  std::uint32_t fields = 0;
  snapshot.head = decode_head(bytes, snapshot.state, fields);
  if (!decode_users(bytes, snapshot.state)) return damaged("its head is malformed");
  if (snapshot.head.kernel_version != kKernelVersion && !of_any_kernel) {
    return damaged("it is of version " + std::to_string(snapshot.head.kernel_version) +
                   " of the kernel");
  }
  if (fields != axes_of(like.settings().rays).size()) return damaged("it is of another block");
  auto solid = read_solid(in, like);
  if (!solid) return std::unexpected(solid.error());
  snapshot.state.solid = *std::move(solid);
  if (snapshot.state.solid.hash() != snapshot.head.hash) {
    return damaged("its columns do not have the hash that it states");
  }
  return snapshot;
}

}  // namespace

std::filesystem::path snapshot_file(const std::filesystem::path& journal) {
  return journal.string() + "-snapshot";
}

std::filesystem::path previous_snapshot_file(const std::filesystem::path& journal) {
  return snapshot_file(journal).string() + "-previous";
}

std::expected<std::uint64_t, SnapshotError> write_snapshot(const std::filesystem::path& file,
                                                           const SnapshotHead& head,
                                                           const SculptureState& state,
                                                           const std::filesystem::path& keep_as) {
  ChunkWriter out(file, kSnapshotVersion);
  out.write(encode_head(head, state));
  write_tiles(out, state.solid);
  const auto written = out.finish(keep_as);
  if (!written) return damaged(written.error());
  return *written;
}

std::expected<SnapshotHead, SnapshotError> read_snapshot_head(const std::filesystem::path& file) {
  ChunkReader in(file, kSnapshotVersion);
  const auto chunk = first_chunk(file, in);
  if (!chunk) return std::unexpected(chunk.error());
  ByteReader bytes(*chunk);
  SculptureState state;
  std::uint32_t fields = 0;
  SnapshotHead head = decode_head(bytes, state, fields);
  if (bytes.truncated()) return damaged("its head is malformed");
  return head;
}

std::expected<BlockSnapshot, SnapshotError> read_snapshot(const std::filesystem::path& file,
                                                          const Sculpture& like) {
  ChunkReader in(file, kSnapshotVersion);
  const auto chunk = first_chunk(file, in);
  if (!chunk) return std::unexpected(chunk.error());
  return read_block(*chunk, in, like, false);
}

std::expected<BlockSnapshot, SnapshotError> read_stored_snapshot(std::string contents,
                                                                 const Sculpture& like) {
  ChunkReader in(std::move(contents), kSnapshotVersion);
  const auto chunk = in.next();
  if (!chunk) return damaged(chunk.error());
  return read_block(*chunk, in, like, true);
}

}  // namespace kerf
