// SPDX-License-Identifier: Apache-2.0
// The files of a session: a batch, and a whole journal.
#include <fstream>

#include "server/store/journal_reader.h"
#include "server/store/record_batch.h"
#include "tests/fuzz/targets.h"
#include "tests/server/temporary_folder.h"

namespace kerf::fuzz {

/// Batches of one journal, each after two bytes with the number of its records and two with its
/// size. Those that can be decoded have as many records as stated, and can be encoded again.
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

void read_journal(Bytes input) {
  static const test::TemporaryFolder folder;
  const auto file = folder / "fuzz.kerf";
  std::ofstream(file, std::ios::binary).write(text_of(input).data(), std::ssize(input));
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
