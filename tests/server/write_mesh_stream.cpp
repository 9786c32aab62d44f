// SPDX-License-Identifier: Apache-2.0
// Writes the messages of a server to a verifying viewer, over half an hour in which a block is
// carved now and then: mesh frames, state messages and the digests of all tiles, for the tests of
// the page (web/test/support/mesh_stream.bin). Usage: write_mesh_stream FILE

#include <cstdio>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "server/feed/column_digest.h"
#include "server/feed/tile_feed.h"
#include "server/wire/codec.h"
#include "tests/support/carvings.h"

namespace {

using namespace kerf;

constexpr std::uint32_t kMinutes = 30, kMotionsAtOnce = 3, kMotionMs = 300, kPauseMs = 180'000;

/// A part of the stream: u32 kind, u32 ms since the first, u32 bytes, and the bytes.
enum class Part : std::uint32_t { kMesh, kState, kDigests };

class Stream {
 public:
  explicit Stream(const char* path) : file_(path, std::ios::binary) {}

  void add(Part part, std::uint32_t ms, std::span<const std::byte> bytes) {
    for (const auto word :
         {static_cast<std::uint32_t>(part), ms, static_cast<std::uint32_t>(bytes.size())}) {
      file_.write(reinterpret_cast<const char*>(&word), sizeof(word));
    }
    file_.write(reinterpret_cast<const char*>(bytes.data()),
                static_cast<std::streamsize>(bytes.size()));
  }
  void add(Part part, std::uint32_t ms, const std::string& text) {
    add(part, ms, std::as_bytes(std::span(text)));
  }
  bool close() {
    file_.close();
    return bool(file_);
  }

 private:
  std::ofstream file_;
};

std::string digests_of(const SolidSnapshot& solid) {
  const DexelGrid& grid = solid.grid();
  std::string text;
  for (std::int32_t y = 0; y < grid.tiles_y(); ++y) {
    for (std::int32_t x = 0; x < grid.tiles_x(); ++x) {
      char line[64];
      std::snprintf(line, sizeof(line), "%d %d %016llx\n", x, y,
                    static_cast<unsigned long long>(column_digest(solid, {x, y})));
      text += line;
    }
  }
  return text;
}

std::string state_of(Sculpture& sculpture) {
  char text[160];
  std::snprintf(text, sizeof(text),
                R"({"type":"state","motions":%llu,"removed_volume_mm3":0,)"
                R"("state_hash":"%016llx","settled":true})",
                static_cast<unsigned long long>(sculpture.motions()),
                static_cast<unsigned long long>(sculpture.state_hash()));
  return text;
}

/// Sends all changes, acknowledges them at once, and sends the state.
void send(Sculpture& sculpture, TileFeed& feed, ViewerId viewer, std::uint32_t ms, Stream& to) {
  while (auto mesh = feed.next_frame(viewer)) {
    feed.ack(viewer, mesh->sequence);
    const auto header = wire::summed_mesh_header({2, mesh->sequence, std::uint64_t{1000} * ms},
                                                 mesh->flags, mesh->glb->size(), mesh->sum);
    std::vector<std::byte> bytes(header.begin(), header.end());
    bytes.insert(bytes.end(), mesh->glb->begin(), mesh->glb->end());
    to.add(Part::kMesh, ms, bytes);
  }
  to.add(Part::kState, ms, state_of(sculpture));
  to.add(Part::kDigests, ms, digests_of(sculpture.solid()));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write_mesh_stream FILE\n");
    return 2;
  }
  const BoxStock block{{0, 0, 0}, {40, 30, 8}};
  Sculpture sculpture = test::make_sculpture(block, 0.625);
  test::RandomCarver carver(sculpture, {0, 0, 7}, block.max_mm, 4);
  TileFeed feed(sculpture.solid(), 0, {.frame_bytes_max = 4096});
  const ViewerId viewer = feed.add_viewer(ViewerLook{{20, 15, 3000}, 0.001}, TileNodes::kVerified);
  Stream to(argv[1]);
  send(sculpture, feed, viewer, 0, to);
  for (std::uint32_t ms = kPauseMs / 2; ms < kMinutes * 60'000; ms += kPauseMs) {
    for (std::uint32_t n = 0; n < kMotionsAtOnce; ++n) {
      const auto changed = carver.cut();
      feed.note_change(sculpture.solid(), changed, sculpture.motions());
      send(sculpture, feed, viewer, ms + n * kMotionMs, to);
    }
  }
  if (to.close()) return 0;
  std::fprintf(stderr, "%s: cannot write\n", argv[1]);
  return 1;
}
