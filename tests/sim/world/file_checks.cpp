// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/file_checks.h"

#include <fstream>
#include <optional>
#include <sstream>
#include <vector>

#include "server/formats/program.h"
#include "server/session/journal_check.h"
#include "server/session/replay.h"
#include "server/session/session_export.h"
#include "server/store/journal_reader.h"
#include "server/store/journal_record.h"
#include "tests/sim/os/scheduler.h"

namespace kerf::sim {
namespace {

constexpr int kFlips = 24;

/// The records of a journal, encoded, and its lists.
struct Contents {
  std::vector<std::vector<std::byte>> records;
  Lists lists;
  bool operator==(const Contents&) const = default;
};

/// Returns the contents of a journal; nullopt if its reader reports damage.
std::optional<Contents> contents_of(const std::filesystem::path& journal) {
  auto reader = JournalReader::open(journal);
  if (!reader) return std::nullopt;
  Contents contents{{}, reader->lists()};
  for (;;) {
    const auto record = reader->next();
    if (!record) return std::nullopt;
    if (!*record) return contents;
    contents.records.push_back(encode_command((*record)->command));
  }
}

void flip_bit(const std::filesystem::path& file, std::uint64_t bit) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  const auto at = static_cast<std::streamoff>(bit / 8);
  stream.seekg(at);
  const int byte = stream.get();
  stream.seekp(at);
  stream.put(static_cast<char>(byte ^ (1 << (bit % 8))));
}

}  // namespace

std::string check_export(const std::filesystem::path& journal, std::uint64_t hash) {
  std::ostringstream text;
  const auto written = export_program(journal, {.style = {.format = ProgramFormat::kGcode}}, text);
  if (!written) return "the program cannot be exported: " + written.error();
  const auto block = replay(journal);
  if (!block) return "the journal cannot be replayed: " + describe(block.error());
  const auto program = parse_program("export.ngc", text.str(), block->scene);
  if (!program) return "the exported program cannot be read: " + to_string(program.error());
  Sculpture carved = Sculpture::create(block->scene.settings).value();
  for (const auto& [id, tool] : block->scene.tools) {
    carved.apply(DefineTool{id, tool.tool}).value();
  }
  for (const ProgramMotion& motion : program->motions) {
    carved.apply(MoveTool{motion.tool, motion.from, motion.to, motion.duration_s, false}).value();
  }
  if (carved.state_hash() == hash) return {};
  return "the exported program of " + std::to_string(program->motions.size()) +
         " motions carves another block";
}

std::string check_rot(const std::filesystem::path& journal, const std::filesystem::path& folder) {
  const auto before = contents_of(journal);
  if (!before) return {};  // another check has reported it
  const auto copy = folder / "rotten.kerf";
  std::filesystem::copy_file(journal, copy, std::filesystem::copy_options::overwrite_existing);
  std::string unnoticed;
  for (int flip = 0; flip < kFlips && unnoticed.empty(); ++flip) {
    const std::uint64_t bit = draw(8 * std::filesystem::file_size(copy));
    flip_bit(copy, bit);
    const auto after = contents_of(copy);
    const bool is_changed = after && *after != *before;
    if (is_changed && check_journal(copy).faults.empty()) {
      unnoticed =
          "bit " + std::to_string(bit) + " of the journal was flipped, and nothing reports it";
    }
    flip_bit(copy, bit);
  }
  std::filesystem::remove(copy);
  return unnoticed;
}

}  // namespace kerf::sim
