// SPDX-License-Identifier: Apache-2.0
#pragma once

// What a page calls: one block, and two buffers through which texts, frames and meshes pass. All
// numbers are little-endian, as WebAssembly's are.

#include <cstddef>
#include <cstdint>

extern "C" {

/// Returns where the next call reads `bytes` bytes.
std::byte* kerf_input(std::uint32_t bytes);

/// Returns where the last call has put what it returns.
const std::byte* kerf_output();

/// Opens the block of the welcome in the input. Returns 0, or the number of bytes of a sentence in
/// the output: why it cannot.
std::uint32_t kerf_open();

/// PageBlock::define_tools of the message in the input. Returns as kerf_open does.
std::uint32_t kerf_tools();

/// PageBlock::take of the frame in the input. This and the others below need an open block.
bool kerf_take();

/// PageBlock::force_n.
double kerf_force();

/// PageBlock::change and PageBlock::settle.
void kerf_change(bool undone);
void kerf_settle();

/// PageBlock::changed: returns the number of tiles, and puts a ChangedTile of each into the output.
std::uint32_t kerf_changed();

/// PageBlock::mesh: returns the number of vertices. The output is the number of indices, 32 bits,
/// the positions and the normals of the vertices, three 32-bit floats each, the indices, 32 bits
/// each, and a byte for each vertex: TileMesh::original.
std::uint32_t kerf_mesh(std::int32_t x, std::int32_t y);

/// PageBlock::hash.
std::uint64_t kerf_hash();

}  // extern "C"
