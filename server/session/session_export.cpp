// SPDX-License-Identifier: Apache-2.0
#include "server/session/session_export.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>
#include <set>
#include <vector>

#include "kernel/sculpture_state.h"
#include "server/formats/forces_csv.h"
#include "server/history/recorded_block.h"
#include "server/session/force_plot.h"
#include "server/session/participant.h"
#include "server/session/replay.h"

namespace kerf {
namespace {

/// Calls `use` with each remaining record up to `last`; stops at the first error of the journal or
/// of `use`.
template <typename Use>
ExportResult for_each_record(JournalReader& reader, std::uint64_t last, const std::stop_token& stop,
                             Use&& use) {
  for (;;) {
    if (stop.stop_requested()) return std::unexpected("stopped");
    const auto record = reader.next();
    if (!record) return std::unexpected(describe(record.error()));
    if (!*record || (*record)->sequence > last) return {};
    if (auto ok = use(**record); !ok) return ok;
  }
}

bool is_requested(const JournalRecord& record, const ProgramRequest& request,
                  const StrokeSet& undone) {
  return !undone.contains(record.stroke) && record.sequence >= request.first &&
         record.sequence <= request.last && (!request.only || *request.only == record.participant);
}

/// The motions of a journal that belong in a program.
class WrittenPath {
 public:
  explicit WrittenPath(const std::vector<JournalParticipant>& participants) {
    for (const JournalParticipant& participant : participants) {
      if (participant.kind == to_string(ParticipantKind::kProgram))
        programs_.insert(participant.participant);
    }
  }
  /// Whether to write a motion. A motion of no length is written if the path did not come there
  /// with that tool, because the tool leaves its imprint. Other rests of agents, a thousand a
  /// second, are dropped. Dwells of programs are kept.
  bool needs(const MoveTool& move, ParticipantId participant) {
    const bool is_there = last_ && last_->tool == move.tool && last_->to == move.to;
    if (is_there && move.from == move.to && !programs_.contains(participant)) return false;
    last_ = move;
    return true;
  }

 private:
  std::set<ParticipantId> programs_;
  std::optional<MoveTool> last_;
};

/// A journal whose forces are recomputed.
struct FeltJournal {
  std::unique_ptr<JournalReader> reader;
  StrokeSet undone;
  std::unique_ptr<Sculpture> block;
  std::uint64_t last;  ///< record of the block
};

/// Restores a block to `start`, with the tools of its scene.
ExportResult go_to(const FeltStart& start, const Scene& scene, Sculpture& block) {
  SculptureState state;
  state.solid = start.solid;
  if (!block.restore(state)) return std::unexpected("the block is of another size");
  for (const auto& [id, tool] : scene.tools) {
    if (auto ok = block.apply(DefineTool{id, tool.tool}); !ok) {
      return std::unexpected(ok.error().reason);
    }
  }
  return {};
}

std::expected<FeltJournal, std::string> open_felt(const std::filesystem::path& journal,
                                                  const FeltStart* start,
                                                  const std::stop_token& stop) {
  auto reader = JournalReader::open(journal, RecordOrder::kSequence, stop);
  if (!reader) return std::unexpected(describe(reader.error()));
  auto undone = start != nullptr ? std::expected<StrokeSet, std::string>(start->undone)
                                 : undone_strokes(journal, reader->last_sequence(), stop);
  if (!undone) return std::unexpected(undone.error());
  const auto scene = journal_scene(*reader, journal, stop);
  if (!scene) return std::unexpected(describe(scene.error()));
  auto first = first_block(*reader, *scene, journal, stop);
  if (!first) return std::unexpected(describe(first.error()));
  if (start != nullptr) {
    if (auto ok = go_to(*start, *scene, first->sculpture); !ok) return std::unexpected(ok.error());
  }
  return FeltJournal{std::make_unique<JournalReader>(*std::move(reader)), *std::move(undone),
                     std::make_unique<Sculpture>(std::move(first->sculpture)),
                     start != nullptr ? start->last : 0};
}

struct FeltMotion {
  const JournalRecord& record;
  const MoveTool& move;
  const MotionResult& result;
  double end_s = 0;  ///< of all motions so far, or of one participant's, undone ones included
};

/// Carves the records after the block's own, up to `last`, without undone strokes. Calls `use` with
/// each motion, or with each motion of one participant.
template <typename Use>
ExportResult for_each_felt(const FeltJournal& journal, std::optional<ParticipantId> only,
                           std::uint64_t last, const std::stop_token& stop, Use&& use) {
  double end_s = 0;
  const auto apply = [&](const JournalRecord& record) -> ExportResult {
    auto command = kernel_command(record.command);
    if (!command) return {};
    auto* move = std::get_if<MoveTool>(&*command);
    if (move != nullptr) move->feel = !only || *only == record.participant;
    if (move != nullptr && move->feel) end_s += move->duration_s;
    if (record.sequence <= journal.last || journal.undone.contains(record.stroke)) return {};
    const auto result = journal.block->apply(*command);
    if (!result) return std::unexpected(result.error().reason);
    if (move != nullptr && move->feel) use(FeltMotion{record, *move, *result, end_s});
    return {};
  };
  return for_each_record(*journal.reader, last, stop, apply);
}

}  // namespace

ExportResult export_program(const std::filesystem::path& journal, const ProgramRequest& request,
                            std::ostream& out, const std::stop_token& stop) {
  // The path of one participant needs no sorting.
  const auto order = request.only ? RecordOrder::kSequence : RecordOrder::kParticipant;
  auto reader = JournalReader::open(journal, order, stop);
  if (!reader) return std::unexpected(describe(reader.error()));
  const auto undone = undone_strokes(journal, reader->last_sequence(), stop);
  if (!undone) return std::unexpected(undone.error());
  const auto scene = journal_scene(*reader, journal, stop);
  if (!scene) return std::unexpected(describe(scene.error()));
  const auto made = make_program_writer(request.style, *scene, out);
  if (!made) return std::unexpected(made.error());
  ProgramWriter& writer = **made;
  WrittenPath path(reader->participants());
  auto written =
      for_each_record(*reader, UINT64_MAX, stop, [&](const JournalRecord& record) -> ExportResult {
        const auto* move = std::get_if<MoveTool>(&record.command);
        if (move == nullptr || !is_requested(record, request, *undone)) return {};
        if (!path.needs(*move, record.participant)) return {};
        ProgramMotion motion;
        motion.tool = move->tool;
        motion.from = move->from;
        motion.to = move->to;
        motion.duration_s = move->duration_s;
        return writer.add(motion);
      });
  if (!written) return written;
  if (auto ok = writer.finish(); !ok) return ok;
  if (!out) return std::unexpected("cannot write the output");
  return {};
}

ExportResult export_forces(const std::filesystem::path& journal, const ForcesRequest& request,
                           std::ostream& out, const std::stop_token& stop) {
  const auto opened = open_felt(journal, nullptr, stop);
  if (!opened) return std::unexpected(opened.error());
  write_forces_header(out, request.device);
  double time_s = 0;
  auto ok = for_each_felt(*opened, request.only, UINT64_MAX, stop, [&](const FeltMotion& felt) {
    time_s += felt.move.duration_s;
    write_forces_row(out, time_s, felt.move.to, felt.result, request.device);
  });
  if (ok && !out) return std::unexpected("cannot write the output");
  return ok;
}

ExportResult export_force_plot(const std::filesystem::path& journal,
                               const ForcePlotRequest& request, std::ostream& out,
                               const std::stop_token& stop, const FeltStart* start) {
  const auto opened = open_felt(journal, start, stop);
  if (!opened) return std::unexpected(opened.error());
  const std::uint64_t last = std::min(request.last, opened->reader->last_sequence());
  ForcePlot plot(request.first, last, request.points);
  auto ok = for_each_felt(*opened, request.only, last, stop, [&](const FeltMotion& felt) {
    plot.add({.record = felt.record.sequence,
              .wall_ms = felt.record.wall_ms,
              .end_s = felt.end_s,
              .removed_mm3 = felt.result.removed_mm3,
              .tip_mm = felt.move.to.tip_mm,
              .wrench = felt.result.wrench});
  });
  if (!ok) return ok;
  plot.write(out);
  if (!out) return std::unexpected("cannot write the output");
  return {};
}

}  // namespace kerf
