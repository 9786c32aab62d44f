// SPDX-License-Identifier: Apache-2.0
// The files of a session: a batch, and a whole journal.
#include <fstream>

#include "kernel/sculpture.h"
#include "server/store/block_snapshot.h"
#include "server/store/byte_code.h"
#include "server/store/journal_reader.h"
#include "server/store/record_batch.h"
#include "server/store/tile_code.h"
#include "tests/fuzz/targets.h"
#include "tests/support/temporary_folder.h"

namespace kerf::fuzz {

/// Batches of one journal, each after two bytes with the number of its records and two with its
/// size. A batch that can be decoded has as many records as stated, and can be encoded again.
void read_batch(Bytes input) {
  (void)decode_command(input);
  const auto number = [&input](std::size_t at) {
    return std::to_integer<std::size_t>(input[at]) | std::to_integer<std::size_t>(input[at + 1])
                                                         << 8U;
  };
  BatchDecoder decoder, second_decoder;
  BatchEncoder encoder;
  while (input.size() >= 4) {
    const std::size_t count = number(0), size = std::min(number(2), input.size() - 4);
    const auto records = decoder.decode(input.subspan(4, size), count);
    if (!records) return;
    require(records->size() == count, "a batch has as many records as stated");
    const auto again = second_decoder.decode(encoder.encode(*records), count);
    require(again.has_value() && again->size() == count, "an encoded batch can be decoded");
    input = input.subspan(4 + size);
  }
}

namespace {

/// Writes the input to a file in a folder of this process.
std::filesystem::path file_with(Bytes input) {
  static const test::TemporaryFolder kFolder;
  const auto file = kFolder / "fuzz.kerf";
  std::ofstream(file, std::ios::binary) << text_of(input);
  return file;
}

}  // namespace

/// A snapshot of the block in corpus/snapshot: 80 x 80 x 30 mm at 0.5 mm.
void read_snapshot(Bytes input) {
  static const Sculpture kBlock = [] {
    return Sculpture::create({.stock = BoxStock{{-40, -40, -30}, {40, 40, 0}}, .pitch_mm = 0.5})
        .value();
  }();
  const auto file = file_with(input);
  (void)read_snapshot_head(file);
  if (const auto read = kerf::read_snapshot(file, kBlock)) {
    require(read->head.kernel_version > 0, "a snapshot states its kernel");
  }
}

/// The columns of a tile, inside the checksums of a snapshot. A tile that can be read is written as
/// the same tile.
void read_tile(Bytes input) {
  for (const bool keeps_normals : {false, true}) {
    ByteReader in(input);
    const auto tile = decode_tile(in, 1 << 20, keeps_normals);
    if (!tile) continue;
    std::vector<std::byte> bytes;
    encode_tile(*tile, bytes);
    ByteReader again(bytes);
    const auto same = decode_tile(again, 1 << 20, keeps_normals);
    require(same != nullptr, "an encoded tile can be decoded");
    std::vector<std::byte> twice;
    encode_tile(*same, twice);
    require(bytes == twice, "to the same tile");
  }
}

void read_journal(Bytes input) {
  const auto file = file_with(input);
  auto reader = JournalReader::open(file);
  while (reader) {
    const auto record = reader->next();
    if (!record || !*record) break;
  }
  for (const char* suffix : {"-wal", "-shm", "-journal"}) {
    std::filesystem::remove(file.string() + suffix);
  }
}

}  // namespace kerf::fuzz
