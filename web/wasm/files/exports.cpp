// SPDX-License-Identifier: Apache-2.0
#include "web/wasm/files/exports.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/crc32.h"
#include "server/wire/codec.h"
#include "web/wasm/files/journal_block.h"
#include "web/wasm/files/program_block.h"

#define KERF_EXPORT(name) __attribute__((export_name(#name)))

namespace {

using kerf::page::BlockFiles;
using kerf::page::JournalBlock;
using kerf::page::PlayedBlock;
using kerf::page::ProgramBlock;

std::vector<std::byte> g_input, g_output;
std::unique_ptr<PlayedBlock> g_block;
JournalBlock* g_journal = nullptr;  // g_block, if it is one

template <typename T>
void append(std::span<const T> values) {
  const std::span bytes = std::as_bytes(values);
  g_output.insert(g_output.end(), bytes.begin(), bytes.end());
}

std::uint32_t put(std::string_view text) {
  g_output.clear();
  append(std::span<const char>(text));
  return static_cast<std::uint32_t>(g_output.size());
}

std::uint32_t put_error(const std::expected<void, std::string>& done) {
  return put(done ? std::string() : done.error());
}

constexpr std::size_t kPageBytes = 65536, kReserveBytes = std::size_t{32} << 20;

/// Lets the memory, if it has grown, grow by a quarter more. The C library asks for a page at a
/// time, and each growth is a garbage collection in browsers: that took half of the time.
void keep_reserve() {
  static std::size_t known_pages = 0;
  const std::size_t pages = __builtin_wasm_memory_size(0);
  if (pages == known_pages) return;
  void* volatile reserve = std::malloc(std::max(kReserveBytes, pages * kPageBytes / 4));
  std::free(reserve);
  known_pages = __builtin_wasm_memory_size(0);
}

void keep(JournalBlock block) {
  auto journal = std::make_unique<JournalBlock>(std::move(block));
  g_journal = journal.get();
  g_block = std::move(journal);
}

std::string_view input_text() {
  return {reinterpret_cast<const char*>(g_input.data()), g_input.size()};
}

/// Takes the first line off a text.
std::string take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string line(text.substr(0, end));
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

}  // namespace

KERF_EXPORT(kerf_input) std::byte* kerf_input(std::uint32_t bytes) {
  keep_reserve();
  g_input.resize(bytes);
  return g_input.data();
}

KERF_EXPORT(kerf_output) const std::byte* kerf_output() { return g_output.data(); }

KERF_EXPORT(kerf_read) std::uint32_t kerf_read() {
  std::string_view names = input_text();
  BlockFiles files;
  for (std::string* name : {&files.program, &files.scene, &files.stock}) *name = take_line(names);
  g_block.reset();
  auto block = ProgramBlock::read(files);
  if (!block) return put(block.error());
  g_block = std::make_unique<ProgramBlock>(*std::move(block));
  return 0;
}

KERF_EXPORT(kerf_journal) std::uint32_t kerf_journal() {
  g_block.reset();
  auto block = JournalBlock::read(g_input);
  if (!block) return put(block.error());
  keep(*std::move(block));
  return 0;
}

KERF_EXPORT(kerf_records) std::uint32_t kerf_records() {
  keep_reserve();
  return put_error(g_journal->add(g_input));
}

KERF_EXPORT(kerf_make) std::uint32_t kerf_make() { return put_error(g_block->make()); }

KERF_EXPORT(kerf_carve) std::uint32_t kerf_carve(std::uint32_t steps, std::uint32_t feels) {
  keep_reserve();
  return put_error(g_block->carve(steps, feels != 0));
}

KERF_EXPORT(kerf_play) std::uint32_t kerf_play(double until_s, std::uint32_t steps) {
  keep_reserve();
  return put_error(g_block->play(until_s, steps));
}

KERF_EXPORT(kerf_seek) std::uint32_t kerf_seek(std::uint32_t step) {
  keep_reserve();
  return put_error(g_block->seek(step));
}

KERF_EXPORT(kerf_hand) std::uint32_t kerf_hand(std::uint32_t participant, double wall_ms) {
  if (const auto* program = dynamic_cast<const ProgramBlock*>(g_block.get())) {
    auto journal = program->as_journal(static_cast<std::int64_t>(wall_ms));
    if (!journal) return put(journal.error());
    keep(*std::move(journal));
  }
  g_journal->begin_hand(participant);
  return 0;
}

KERF_EXPORT(kerf_samples) std::uint32_t kerf_samples(double wall_ms, double span_ms) {
  keep_reserve();
  const auto message = kerf::wire::decode(g_input);
  const auto* motion = message ? std::get_if<kerf::wire::MotionBatch>(&message->body) : nullptr;
  if (motion == nullptr) return put("the frame has no motions");
  return put_error(g_journal->carve_by_hand(motion->view(), static_cast<std::int64_t>(wall_ms),
                                            static_cast<std::int64_t>(span_ms)));
}

KERF_EXPORT(kerf_change) std::uint32_t kerf_change(std::uint32_t undone, double wall_ms) {
  keep_reserve();
  return put_error(g_journal->change_by_hand(undone != 0, static_cast<std::int64_t>(wall_ms)));
}

KERF_EXPORT(kerf_tool) std::uint32_t kerf_tool(double wall_ms) {
  keep_reserve();
  const auto made = g_journal->make_tool(input_text(), static_cast<std::int64_t>(wall_ms));
  if (!made) return put(made.error());
  g_output.clear();
  append(std::span<const kerf::ToolId>(&*made, 1));
  return 0;
}

KERF_EXPORT(kerf_origin) std::uint32_t kerf_origin() {
  g_output.clear();
  append(g_journal->origin());
  return static_cast<std::uint32_t>(g_output.size());
}

KERF_EXPORT(kerf_rows) std::uint32_t kerf_rows() {
  g_output = g_journal->rows();
  return static_cast<std::uint32_t>(g_output.size());
}

KERF_EXPORT(kerf_checksum) std::uint32_t kerf_checksum() { return kerf::crc32(g_input); }

KERF_EXPORT(kerf_changed) std::uint32_t kerf_changed() {
  g_output.clear();
  const std::vector<kerf::TileIndex> tiles = g_block->changed();
  append(std::span<const kerf::TileIndex>(tiles));
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

KERF_EXPORT(kerf_digest) std::uint64_t kerf_digest(std::int32_t x, std::int32_t y) {
  return g_block->digest({x, y});
}

KERF_EXPORT(kerf_hash) std::uint64_t kerf_hash() { return g_block->hash(); }

KERF_EXPORT(kerf_about) std::uint32_t kerf_about() { return put(g_block->about()); }

KERF_EXPORT(kerf_progress) std::uint32_t kerf_progress() { return put(g_block->progress()); }

KERF_EXPORT(kerf_path) std::uint32_t kerf_path() { return put(g_block->path()); }

KERF_EXPORT(kerf_write) std::uint32_t kerf_write() {
  const auto format = kerf::model_format(input_text());
  if (!format) return put("unknown format");
  return put_error(g_block->write(*format, "model"));
}
