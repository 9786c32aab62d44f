// SPDX-License-Identifier: Apache-2.0
#pragma once

// What a page without a server calls: one program with its block, whose files lie in a folder that
// the page keeps for the module, and two buffers through which texts and meshes pass. All numbers
// are little-endian. A call that returns a number of bytes has put them into the output.

#include <cstddef>
#include <cstdint>

extern "C" {

/// Returns where the next call reads `bytes` bytes.
std::byte* kerf_input(std::uint32_t bytes);

/// Returns where the last call has put what it returns.
const std::byte* kerf_output();

/// ProgramBlock::read: the input has the names of program, scene and stock, a line each. Returns
/// the bytes of the error, 0 if there is none; as do the next two.
std::uint32_t kerf_read();
/// ProgramBlock::make. This needs what was read, and all others below a block.
std::uint32_t kerf_make();
/// ProgramBlock::carve.
std::uint32_t kerf_carve(std::uint32_t motions);

/// ProgramBlock::seek.
void kerf_seek(std::uint32_t motion);

/// ProgramBlock::changed: returns the number of tiles, and puts a TileIndex of each into the
/// output.
std::uint32_t kerf_changed();
/// ProgramBlock::mesh, as in web/wasm/exports.h.
std::uint32_t kerf_mesh(std::int32_t x, std::int32_t y);

/// ProgramBlock::hash.
std::uint64_t kerf_hash();

/// ProgramBlock::about, progress and path: return the bytes of a JSON text.
std::uint32_t kerf_about();
std::uint32_t kerf_progress();
std::uint32_t kerf_path();

/// ProgramBlock::write of the format whose name is the input, as the file "model". Returns the
/// bytes of the error, 0 if there is none.
std::uint32_t kerf_write();

}  // extern "C"
