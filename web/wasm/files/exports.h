// SPDX-License-Identifier: Apache-2.0
#pragma once

// What a page calls that carves by itself: one block, of a program whose files lie in a folder that
// the page keeps for the module, or of a journal, and two buffers through which texts and meshes
// pass. All numbers
// are little-endian. A call that returns a number of bytes has put them into the output.

#include <cstddef>
#include <cstdint>

extern "C" {

/// Returns where the next call reads `bytes` bytes.
std::byte* kerf_input(std::uint32_t bytes);

/// Returns where the last call has put what it returns.
const std::byte* kerf_output();

/// ProgramBlock::read: the input has the names of program, scene and stock, a line each. Returns
/// the bytes of the error, 0 if there is none; as do all down to kerf_tool.
std::uint32_t kerf_read();
/// JournalBlock::read of the input.
std::uint32_t kerf_journal();
/// JournalBlock::add of the input. This needs a journal that was read.
std::uint32_t kerf_records();
/// PlayedBlock::make. This needs what was read, and all others below a block.
std::uint32_t kerf_make();
/// PlayedBlock::carve; `feels` is 0 or 1.
std::uint32_t kerf_carve(std::uint32_t steps, std::uint32_t feels);
/// PlayedBlock::play.
std::uint32_t kerf_play(double until_s, std::uint32_t steps);
/// PlayedBlock::seek.
std::uint32_t kerf_seek(std::uint32_t step);

/// The block is carved by hand from now on, JournalBlock::begin_hand: that of a program becomes the
/// journal of what is carved of it, to be made and carved again. `wall_ms` of this and of the
/// following: ms since 1970, UTC.
std::uint32_t kerf_hand(std::uint32_t participant, double wall_ms);
/// JournalBlock::carve_by_hand of the input, a frame of motions (server/wire/README.md).
std::uint32_t kerf_samples(double wall_ms, double span_ms);
/// JournalBlock::change_by_hand; `undone` is 0 or 1.
std::uint32_t kerf_change(std::uint32_t undone, double wall_ms);
/// JournalBlock::make_tool of the input, a tool of a scene: the output is its id, 32 bits.
std::uint32_t kerf_tool(double wall_ms);

/// JournalBlock::origin and rows: return their bytes. These need a journal.
std::uint32_t kerf_origin();
std::uint32_t kerf_rows();
/// Returns the CRC-32 of the input, as tables of a journal have it.
std::uint32_t kerf_checksum();

/// PlayedBlock::changed: returns the number of tiles, and puts a TileIndex of each into the
/// output.
std::uint32_t kerf_changed();
/// PlayedBlock::mesh, as in web/wasm/exports.h.
std::uint32_t kerf_mesh(std::int32_t x, std::int32_t y);

/// PlayedBlock::digest.
std::uint64_t kerf_digest(std::int32_t x, std::int32_t y);

/// PlayedBlock::hash.
std::uint64_t kerf_hash();

/// PlayedBlock::about, progress and path: return the bytes of a JSON text.
std::uint32_t kerf_about();
std::uint32_t kerf_progress();
std::uint32_t kerf_path();

/// PlayedBlock::write of the format whose name is the input, as the file "model". Returns the
/// bytes of the error, 0 if there is none.
std::uint32_t kerf_write();

}  // extern "C"
