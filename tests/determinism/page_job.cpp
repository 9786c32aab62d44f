// SPDX-License-Identifier: Apache-2.0
// Runs a job (page_bytes.mjs) on the functions that kerf.wasm exports, compiled for this machine,
// and prints their results: a line for each welcome, frame and tile; for timed frames, a line for
// each block. A rejected welcome ends it. Usage: page_job FILE

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>
#include <vector>

#include "web/wasm/exports.h"
#include "web/wasm/page_block.h"

namespace {

/// FNV-1a.
std::uint32_t hash_of(const std::byte* bytes, std::size_t count) {
  std::uint32_t hash = 0x811c9dc5U;
  for (std::size_t n = 0; n < count; ++n) {
    hash = (hash ^ std::to_integer<std::uint32_t>(bytes[n])) * 0x01000193U;
  }
  return hash;
}

void print_changed() {
  using kerf::page::ChangedTile;
  std::vector<ChangedTile> tiles(kerf_changed());
  if (!tiles.empty()) std::memcpy(tiles.data(), kerf_output(), tiles.size() * sizeof(ChangedTile));
  for (const ChangedTile& tile : tiles) {
    const std::size_t vertices = kerf_mesh(tile.at.x, tile.at.y);
    std::uint32_t indices = 0;
    std::memcpy(&indices, kerf_output(), sizeof indices);
    std::printf("tile %d %d %d: %zu %08x\n", tile.at.x, tile.at.y, tile.by_page, vertices,
                hash_of(kerf_output(), 4 + 25 * vertices + 4 * std::size_t{indices}));
  }
}

/// Time spent on frames of a block that are only carved, and on displaying tiles afterwards.
std::chrono::duration<double, std::milli> g_carved, g_displayed;

void print_times() {
  if (g_carved.count() > 0) {
    std::printf("time %.3f %.3f\n", g_carved.count(), g_displayed.count());
  }
  g_carved = g_displayed = {};
}

void run_timed(char kind) {
  const auto begin = std::chrono::steady_clock::now();
  if (kind == 'c') {
    kerf_take();
    g_carved += std::chrono::steady_clock::now() - begin;
    return;
  }
  std::vector<kerf::page::ChangedTile> tiles(kerf_changed());
  if (!tiles.empty()) std::memcpy(tiles.data(), kerf_output(), tiles.size() * sizeof tiles[0]);
  for (const auto& tile : tiles) kerf_mesh(tile.at.x, tile.at.y);
  g_displayed += std::chrono::steady_clock::now() - begin;
}

/// Ends the program, because no other frame can be processed without a block.
[[noreturn]] void stop_rejected(std::uint32_t length) {
  std::fprintf(stderr, "The welcome is rejected: %.*s\n", static_cast<int>(length),
               reinterpret_cast<const char*>(kerf_output()));
  std::exit(1);
}

void run(char kind, std::span<const char> bytes) {
  std::memcpy(kerf_input(static_cast<std::uint32_t>(bytes.size())), bytes.data(), bytes.size());
  if (kind == 'w') {
    print_times();
    const std::uint32_t error = kerf_open();
    std::printf("open %u\n", error);
    if (error > 0) stop_rejected(error);
  } else if (kind == 'u' || kind == 'r') {
    kerf_change(kind == 'u');
    print_changed();
  } else if (kind == 's') {
    kerf_settle();
    print_changed();
  } else if (kind == 'c' || kind == 'd') {
    run_timed(kind);
  } else {
    const bool taken = kerf_take();
    std::printf("take %d %016llx\n", int{taken}, static_cast<unsigned long long>(kerf_hash()));
    print_changed();
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::ifstream file(argc > 1 ? argv[1] : "", std::ios::binary);
  const std::vector<char> job{std::istreambuf_iterator<char>(file), {}};
  for (std::size_t at = 0; at + 5 <= job.size();) {
    std::uint32_t bytes = 0;
    std::memcpy(&bytes, &job[at + 1], sizeof bytes);
    run(job[at], std::span(job).subspan(at + 5, bytes));
    at += 5 + bytes;
  }
  print_times();
  return job.empty() ? 1 : 0;
}
