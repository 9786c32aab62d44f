// SPDX-License-Identifier: Apache-2.0
#include "web/wasm/exports.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "web/wasm/page_block.h"

#ifdef __wasm__
#define KERF_EXPORT(name) __attribute__((export_name(#name)))
#else
#define KERF_EXPORT(name)  // a test compares both
#endif

namespace {

using kerf::page::ChangedTile;
using kerf::page::PageBlock;

std::vector<std::byte> g_input, g_output;
std::optional<PageBlock> g_block;

template <typename T>
void append(std::span<const T> values) {
  const std::span bytes = std::as_bytes(values);
  g_output.insert(g_output.end(), bytes.begin(), bytes.end());
}

}  // namespace

KERF_EXPORT(kerf_input) std::byte* kerf_input(std::uint32_t bytes) {
  g_input.resize(bytes);
  return g_input.data();
}

KERF_EXPORT(kerf_output) const std::byte* kerf_output() { return g_output.data(); }

KERF_EXPORT(kerf_open) std::uint32_t kerf_open() {
  g_output.clear();
  auto block = PageBlock::open({reinterpret_cast<const char*>(g_input.data()), g_input.size()});
  if (block) {
    g_block.emplace(*std::move(block));
  } else {
    append(std::span<const char>(block.error()));
  }
  return static_cast<std::uint32_t>(g_output.size());
}

KERF_EXPORT(kerf_tools) std::uint32_t kerf_tools() {
  g_output.clear();
  const auto defined =
      g_block->define_tools({reinterpret_cast<const char*>(g_input.data()), g_input.size()});
  if (!defined) append(std::span<const char>(defined.error()));
  return static_cast<std::uint32_t>(g_output.size());
}

KERF_EXPORT(kerf_take) bool kerf_take() { return g_block->take(g_input); }

KERF_EXPORT(kerf_force) double kerf_force() { return g_block->force_n(); }

KERF_EXPORT(kerf_change) void kerf_change(bool undone) { g_block->change(undone); }

KERF_EXPORT(kerf_settle) void kerf_settle() { g_block->settle(); }

KERF_EXPORT(kerf_changed) std::uint32_t kerf_changed() {
  g_output.clear();
  const std::vector<ChangedTile> tiles = g_block->changed();
  append(std::span<const ChangedTile>(tiles));
  return static_cast<std::uint32_t>(tiles.size());
}

KERF_EXPORT(kerf_mesh) std::uint32_t kerf_mesh(std::int32_t x, std::int32_t y) {
  g_output.clear();
  const kerf::TileMesh mesh = g_block->mesh({x, y});
  const auto indices = static_cast<std::uint32_t>(mesh.indices.size());
  append(std::span(&indices, 1));
  append(std::span<const std::array<float, 3>>(mesh.positions_mm));
  append(std::span<const std::array<float, 3>>(mesh.normals));
  append(std::span<const std::uint32_t>(mesh.indices));
  append(std::span<const std::uint8_t>(mesh.original));
  return static_cast<std::uint32_t>(mesh.positions_mm.size());
}

KERF_EXPORT(kerf_hash) std::uint64_t kerf_hash() { return g_block->hash(); }
