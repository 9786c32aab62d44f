// SPDX-License-Identifier: Apache-2.0
#include "server/session/journal_salvage.h"

#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "server/history/stroke_table.h"
#include "server/session/replay.h"
#include "server/store/block_snapshot.h"
#include "server/store/journal_base.h"
#include "server/store/salvage_writer.h"

namespace kerf {
namespace {

using Written = std::expected<void, JournalError>;

JournalError bad_journal(const std::filesystem::path& file, std::uint64_t sequence,
                         std::string reason) {
  return {JournalErrorCode::kCorrupt, file.string(), sequence, std::move(reason)};
}

/// The records of a journal up to the first bad one.
struct GoodRecords {
  std::uint64_t last = 0;
  std::vector<StrokeId> strokes;  ///< first records of the strokes that begin in them
  JournalError damage = {};       ///< empty reason if no record is bad
};

std::expected<GoodRecords, JournalError> find_damage(JournalReader& reader) {
  GoodRecords good;
  good.last = base_record(reader.header().files);
  for (;;) {
    auto record = reader.next();
    if (!record && record.error().code != JournalErrorCode::kCorrupt) {
      return std::unexpected(record.error());
    }
    if (!record) {
      good.damage = record.error();
      if (good.damage.sequence == 0) good.damage.sequence = good.last + 1;
    }
    if (!record || !*record) return good;
    good.last = (*record)->sequence;
    if ((*record)->stroke == good.last) good.strokes.push_back(good.last);
  }
}

/// A snapshot with which a new journal can begin.
struct Base {
  std::filesystem::path file;
  std::string contents;
  BlockSnapshot snapshot;
  /// The record before the first one of the new journal, which begins by defining the tools again.
  std::uint64_t before() const { return snapshot.head.sequence - snapshot.state.tools.size(); }
};

std::optional<std::string> read_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string contents{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return in.good() || in.eof() ? std::optional(std::move(contents)) : std::nullopt;
}

/// Whether a snapshot belongs to this journal and was taken after record `least` or later.
bool is_of(const SnapshotHead& head, JournalReader& reader, std::uint64_t least) {
  if (head.session != reader.header().session || head.sequence < least) return false;
  if (head.kernel_version != reader.header().kernel_version) return false;
  if (head.sequence > reader.last_sequence()) return false;
  const auto mark = reader.mark(head.sequence);
  return !mark || *mark == head.mark;  // the row may be on a damaged page
}

/// Returns the newest snapshot taken after record `least` or later.
std::optional<Base> find_base(const std::filesystem::path& journal, JournalReader& reader,
                              const Sculpture& like, std::uint64_t least) {
  for (const auto& file : {snapshot_file(journal), previous_snapshot_file(journal)}) {
    const auto head = read_snapshot_head(file);
    if (!head || !is_of(*head, reader, least)) continue;
    auto contents = read_file(file);
    if (!contents) continue;
    auto snapshot = read_stored_snapshot(*contents, like);
    if (!snapshot || snapshot->state.tools.size() >= snapshot->head.sequence) continue;
    return Base{file, *std::move(contents), *std::move(snapshot)};
  }
  return std::nullopt;
}

/// Copies the records from `first` on to the new journal.
class RecordCopy {
 public:
  RecordCopy(SalvageWriter& writer, SalvagedJournal& salvaged)
      : writer_(writer), salvaged_(salvaged) {}

  Written define_tools(const Base& base) {
    std::uint64_t sequence = base.before();
    for (const auto& [id, tool] : base.snapshot.state.tools) {
      JournalRecord record{++sequence, 0, DefineTool{id, tool}};
      if (auto ok = writer_.append(record, false); !ok) return ok;
    }
    salvaged_.last = sequence;
    return {};
  }
  /// Copies records up to the next bad one, which is not an error.
  Written copy(JournalReader& reader) {
    for (;;) {
      const auto record = reader.next();
      if (!record && record.error().code != JournalErrorCode::kCorrupt) {
        return std::unexpected(record.error());
      }
      if (!record || !*record) return {};
      if (auto ok = add(**record); !ok) return ok;
    }
  }
  /// The first record whose effect differs from that in the damaged journal.
  std::uint64_t hashes_end() const {
    return salvaged_.ignored_changes.empty() ? std::numeric_limits<std::int64_t>::max()
                                             : salvaged_.ignored_changes.front();
  }

 private:
  /// Appends a record. The part of a stroke after the base becomes a new stroke.
  Written add(const JournalRecord& record) {
    salvaged_.last = record.sequence;
    const bool is_motion = std::holds_alternative<MoveTool>(record.command);
    bool begins_stroke = is_motion && record.stroke == record.sequence;
    if (is_motion && salvaged_.base > 0 && record.stroke <= salvaged_.base) {
      begins_stroke = divided_.insert(record.participant).second;
    }
    const auto* change = std::get_if<StrokeChange>(&record.command);
    if (change != nullptr && change->stroke <= salvaged_.base) {
      salvaged_.ignored_changes.push_back(record.sequence);
    }
    return writer_.append(record, begins_stroke);
  }

  SalvageWriter& writer_;
  SalvagedJournal& salvaged_;
  std::set<ParticipantId> divided_;
};

/// Carves the new journal and stores the hash of its block if this kernel can compare it.
Written verify(const std::filesystem::path& file, SalvagedJournal& salvaged) {
  const auto replayed = replay(file);
  if (!replayed) return std::unexpected(replayed.error());
  salvaged.hash = replayed->hash.hash;
  if (replayed->is_recarved() || replayed->hash.sequence == 0) return {};
  auto database = SqlDatabase::open(file, SqlMode::kWrite);
  if (!database) return std::unexpected(to_journal_error(file, database.error()));
  auto insert = database->prepare("INSERT OR REPLACE INTO state_hashes VALUES(?,?)");
  if (!insert) return std::unexpected(to_journal_error(file, insert.error()));
  insert->bind(1, static_cast<std::int64_t>(replayed->hash.sequence));
  insert->bind(2, static_cast<std::int64_t>(replayed->hash.hash));
  if (auto row = insert->step(); !row) return std::unexpected(to_journal_error(file, row.error()));
  return {};
}

}  // namespace

std::expected<SalvagedJournal, JournalError> salvage_journal(const std::filesystem::path& from,
                                                             const std::filesystem::path& to) {
  auto reader = JournalReader::open(from);
  if (!reader) return std::unexpected(reader.error());
  const auto scene = journal_scene(*reader, from);
  if (!scene) return std::unexpected(scene.error());
  const auto good = find_damage(*reader);
  if (!good) return std::unexpected(good.error());
  SalvagedJournal salvaged;
  salvaged.last_before = reader->last_sequence();
  salvaged.damage = good->damage;
  JournalHeader header = reader->header();
  std::optional<Base> base;
  if (!good->damage.reason.empty()) {
    const auto like = Sculpture::create(scene->settings);
    if (!like) return std::unexpected(bad_journal(from, 0, like.error().reason));
    base = find_base(from, *reader, *like, good->damage.sequence);
  }
  if (base) {
    salvaged.base = base->snapshot.head.sequence;
    salvaged.base_file = base->file.filename().string();
    salvaged.fixed_strokes = good->strokes.size();
    header.files.erase(base_name(base_record(header.files)));
    header.files[base_name(base->before())] = std::move(base->contents);
  }
  if (!base && good->last <= base_record(header.files)) {
    return std::unexpected(bad_journal(from, good->damage.sequence,
                                       "no record before it is good, and no snapshot has the block "
                                       "after it: " +
                                           good->damage.reason));
  }
  auto writer = SalvageWriter::create(to, header);
  if (!writer) return std::unexpected(writer.error());
  RecordCopy records(*writer, salvaged);
  if (base) {
    if (auto ok = records.define_tools(*base); !ok) return std::unexpected(ok.error());
  }
  // If the rest cannot be read at all, the new journal ends with the base.
  auto rest = JournalReader::open(from, RecordOrder::kSequence, {}, salvaged.base + 1);
  if (rest) {
    if (auto ok = records.copy(*rest); !ok) return std::unexpected(ok.error());
  }
  auto left_out =
      writer->copy_rest(from, *reader, salvaged.base, salvaged.last, records.hashes_end());
  if (!left_out) return std::unexpected(left_out.error());
  salvaged.left_out = *std::move(left_out);
  const auto written = writer->commit();
  if (!written) return std::unexpected(written.error());
  if (auto ok = verify(*written, salvaged); !ok) return std::unexpected(ok.error());
  if (auto ok = writer->finish(); !ok) return std::unexpected(ok.error());
  return salvaged;
}

std::vector<std::string> describe_salvage(const SalvagedJournal& salvaged) {
  const auto number = [](std::uint64_t n) { return std::to_string(n); };
  std::vector<std::string> lines;
  if (salvaged.damage.reason.empty()) {
    lines.emplace_back("no record is damaged: all of them are kept");
  } else {
    lines.push_back("damaged: record " + number(salvaged.damage.sequence) + ": " +
                    salvaged.damage.reason);
  }
  if (salvaged.base > 0) {
    lines.push_back("kept: the block after record " + number(salvaged.base) + ", of " +
                    salvaged.base_file + ", and " + number(salvaged.last - salvaged.base) +
                    " records after it");
    lines.push_back("lost: the motions of records 1 to " + number(salvaged.base) +
                    ", whose cuts the block has: none of their strokes, at least " +
                    number(salvaged.fixed_strokes) +
                    ", can be undone, exported or looked back at any more");
  } else {
    lines.push_back("kept: the records up to " + number(salvaged.last));
  }
  if (salvaged.last < salvaged.last_before) {
    lines.push_back("lost: records " + number(salvaged.last + 1) + " to " +
                    number(salvaged.last_before) + ", with their cuts");
  }
  for (const std::uint64_t record : salvaged.ignored_changes) {
    lines.push_back("without effect: record " + number(record) +
                    ", which undoes or redoes a stroke before the kept block");
  }
  for (const std::string& part : salvaged.left_out) lines.push_back("lost: " + part);
  return lines;
}

}  // namespace kerf
