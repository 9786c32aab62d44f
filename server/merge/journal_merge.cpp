// SPDX-License-Identifier: Apache-2.0
#include "server/merge/journal_merge.h"

#include <map>
#include <utility>

#include "server/merge/journal_side.h"
#include "server/merge/stroke_merger.h"
#include "server/session/journal_carve.h"
#include "server/store/journal_file.h"
#include "server/store/journal_writer.h"

namespace kerf {
namespace {

using enum MergeErrorCode;

std::unexpected<MergeError> failed(const JournalError& error) {
  return std::unexpected(MergeError{kJournal, describe(error)});
}

/// Both journals, which belong to the same block.
struct Sides {
  JournalSide ours, theirs;
};

std::optional<MergeError> difference(const JournalHeader& ours, const JournalHeader& theirs) {
  if (ours.scene_json != theirs.scene_json || ours.files != theirs.files) {
    return MergeError{kDifferentBlock,
                      "the two files begin with different scenes: only copies of one block, or "
                      "blocks of one scene, can be merged"};
  }
  for (const JournalHeader* side : {&ours, &theirs}) {
    if (side->kernel_version == kKernelVersion) continue;
    return MergeError{kDifferentKernel,
                      "the file of session " + side->session + " was carved by version " +
                          std::to_string(side->kernel_version) +
                          " of the kernel, this is version " + std::to_string(kKernelVersion) +
                          ": serve it once with this kerf-server, which carves it again"};
  }
  return std::nullopt;
}

std::expected<Sides, MergeError> read_sides(const std::filesystem::path& ours,
                                            const std::filesystem::path& theirs,
                                            const std::stop_token& stop) {
  auto first = read_side(ours, stop);
  if (!first) return failed(first.error());
  auto second = read_side(theirs, stop);
  if (!second) return failed(second.error());
  if (auto fault = difference(first->header, second->header)) return std::unexpected(*fault);
  return Sides{*std::move(first), *std::move(second)};
}

std::optional<MergeError> unknown_stroke(const StrokeTable& theirs,
                                         const std::optional<StrokeSet>& chosen) {
  for (const StrokeId stroke : chosen.value_or(StrokeSet())) {
    if (theirs.find(stroke) != nullptr) continue;
    return MergeError{kUnknownStroke,
                      "no stroke of the other file begins with record " + std::to_string(stroke)};
  }
  return std::nullopt;
}

/// Carves a merged journal and stores the hash of its block.
std::expected<void, MergeError> store_hash(const std::filesystem::path& journal,
                                           MergedJournal& merged) {
  const auto carved = carve_without(journal, {});
  if (!carved) return std::unexpected(MergeError{kJournal, carved.error()});
  merged.hash = carved->hash;
  if (merged.last == 0) return {};
  auto writer = JournalWriter::open(journal, merged.last);
  if (!writer) return failed(writer.error());
  writer->append(StateHash{merged.last, merged.hash});
  if (auto ok = writer->finish(); !ok) return failed(ok.error());
  return {};
}

}  // namespace

const char* to_string(MergeErrorCode code) {
  switch (code) {
    case kJournal:
      return "journal";
    case kDifferentBlock:
      return "different_block";
    case kDifferentKernel:
      return "different_kernel";
    case kUnknownStroke:
      return "unknown_stroke";
  }
  return "journal";
}

std::expected<std::vector<OtherStroke>, MergeError> strokes_to_merge(
    const std::filesystem::path& ours, const std::filesystem::path& theirs,
    const std::stop_token& stop) {
  const auto sides = read_sides(ours, theirs, stop);
  if (!sides) return std::unexpected(sides.error());
  const JournalSide& other = sides->theirs;
  std::map<StrokeId, std::uint64_t> missing;
  for (std::uint64_t record = 1; record <= other.last(); ++record) {
    const StrokeId stroke = other.owners[record - 1].stroke;
    if (stroke != 0 && !sides->ours.origins.find(other.origins.of(record))) ++missing[stroke];
  }
  std::map<ParticipantId, std::string> names;
  for (const auto& one : other.participants) names.emplace(one.participant, one.name);
  std::vector<OtherStroke> strokes;
  for (const auto& [id, motions] : missing) {
    const Stroke& stroke = *other.strokes.find(id);
    const auto mark = other.marks.find(id);
    strokes.push_back({id, names[stroke.participant], motions,
                       mark != other.marks.end() && mark->second.undone, stroke.begin_ms});
  }
  return strokes;
}

std::expected<MergedJournal, MergeError> append_merged(const std::filesystem::path& ours,
                                                       const std::filesystem::path& theirs,
                                                       const std::optional<StrokeSet>& chosen,
                                                       const std::stop_token& stop) {
  const auto sides = read_sides(ours, theirs, stop);
  if (!sides) return std::unexpected(sides.error());
  if (auto fault = unknown_stroke(sides->theirs.strokes, chosen)) return std::unexpected(*fault);
  auto writer = JournalWriter::open(ours, sides->ours.last());
  if (!writer) return failed(writer.error());
  StrokeMerger merger(sides->ours, sides->theirs, chosen, *writer);
  auto reader = JournalReader::open(theirs, RecordOrder::kSequence, stop);
  if (!reader) return failed(reader.error());
  for (;;) {
    const auto record = reader->next();
    if (!record) return failed(record.error());
    // Records that were appended since the sides were read are left for the next merge.
    if (!*record || (*record)->sequence > sides->theirs.last()) break;
    if (auto ok = merger.take(**record); !ok) return failed(ok.error());
  }
  if (auto ok = merger.take_rest(); !ok) return failed(ok.error());
  if (auto ok = writer->finish(); !ok) return failed(ok.error());
  return merger.merged();
}

std::expected<MergedJournal, MergeError> merge_journals(const std::filesystem::path& ours,
                                                        const std::filesystem::path& theirs,
                                                        const std::filesystem::path& out,
                                                        const std::optional<StrokeSet>& chosen) {
  const auto copy = unfinished_journal(out);
  if (!copy) return failed(copy.error());
  if (auto ok = copy_journal(ours, *copy); !ok) return failed(ok.error());
  auto merged = append_merged(*copy, theirs, chosen);
  if (merged) {
    if (auto ok = store_hash(*copy, *merged); !ok) merged = std::unexpected(ok.error());
  }
  if (merged) {
    if (const std::error_code error = rename_new(*copy, out)) {
      merged = std::unexpected(MergeError{kJournal, out.string() + ": " + error.message()});
    }
  }
  remove_journal(*copy);
  return merged;
}

}  // namespace kerf
