// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_scan.h"

#include <algorithm>
#include <string>
#include <utility>

#include "server/store/batch_rows.h"
#include "server/store/journal_base.h"
#include "server/store/journal_file.h"
#include "server/store/journal_reader.h"
#include "server/store/record_rows.h"

namespace kerf {
namespace {

constexpr std::size_t kPartBytes = std::size_t{4} << 20;  ///< used by finish()

}  // namespace

std::unexpected<JournalError> JournalScan::corrupt(std::uint64_t sequence,
                                                   std::string reason) const {
  return std::unexpected(
      JournalError{JournalErrorCode::kCorrupt, file_.string(), sequence, std::move(reason)});
}

std::unexpected<JournalError> JournalScan::failed(const SqlError& error) const {
  JournalError found = to_journal_error(file_, error);
  found.sequence = verified_ + 1;
  return std::unexpected(std::move(found));
}

std::expected<bool, JournalError> JournalScan::advance(std::size_t bytes,
                                                       const std::stop_token& stop) {
  if (stop.stop_requested()) {
    return std::unexpected(JournalError{JournalErrorCode::kIo, file_.string(), 0, "stopped"});
  }
  if (!has_head_) {
    const auto head = JournalReader::open(file_, RecordOrder::kSequence, stop);
    if (!head) return std::unexpected(head.error());
    verified_ = base_record(head->header().files);
    has_head_ = true;
  }
  auto database = open_journal(file_, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  if (stop.stop_possible()) database->end_on(stop);
  // One transaction: otherwise records committed meanwhile would look like a gap.
  if (auto ok = database->execute("BEGIN"); !ok) return failed(ok.error());
  return scan(*database, bytes);
}

std::expected<bool, JournalError> JournalScan::scan(SqlDatabase& database, std::size_t bytes) {
  const auto last = last_record(database);
  if (!last) return failed(last.error());
  if (*last < verified_) return true;  // a copy may be truncated and continued
  const auto singles = scan_singles(database, bytes);
  if (!singles || !*singles) return singles;
  const auto batches = scan_batches(database, bytes);
  if (!batches || !*batches || verified_ == *last) return batches;
  return corrupt(verified_ + 1, std::to_string(*last - verified_) + " records are missing");
}

/// Verifies the rows of version 1, which come before the batches. Returns true after the last one.
std::expected<bool, JournalError> JournalScan::scan_singles(SqlDatabase& database,
                                                            std::size_t& bytes) {
  const auto exists = database.has_table("commands");
  if (!exists) return failed(exists.error());
  if (!*exists) return true;
  auto rows =
      database.prepare("SELECT sequence, participant, bytes, crc FROM commands WHERE sequence>" +
                       std::to_string(verified_) + " ORDER BY sequence");
  if (!rows) return failed(rows.error());
  while (bytes > 0) {
    const auto row = rows->step();
    if (!row) return failed(row.error());
    if (!*row) return true;
    const auto sequence = static_cast<std::uint64_t>(rows->integer(0));
    if (sequence != verified_ + 1) return corrupt(verified_ + 1, "the record is missing");
    const auto content = rows->blob(2);
    const auto participant = static_cast<ParticipantId>(rows->integer(1));
    if (rows->integer(3) != std::int64_t{record_checksum(sequence, participant, content)}) {
      return corrupt(sequence, "the checksum of the record is wrong");
    }
    verified_ = sequence;
    bytes -= std::min(bytes, content.size() + 1);
  }
  return false;
}

std::expected<bool, JournalError> JournalScan::scan_batches(SqlDatabase& database,
                                                            std::size_t& bytes) {
  const auto exists = database.has_table("batches");
  if (!exists) return failed(exists.error());
  if (!*exists) return true;
  auto rows = database.prepare(
      "SELECT first, count, wall_ms, span_ms, bytes, crc FROM batches WHERE first>" +
      std::to_string(verified_) + " ORDER BY first");
  if (!rows) return failed(rows.error());
  while (bytes > 0) {
    const auto row = rows->step();
    if (!row) return failed(row.error());
    if (!*row) return true;
    const BatchRow batch = batch_of(*rows);
    if (auto good = verify_row(batch, verified_); !good) {
      return corrupt(good.error().sequence, std::move(good.error().reason));
    }
    verified_ += batch.head.count;
    bytes -= std::min(bytes, batch.bytes.size() + 1);
  }
  return false;
}

std::expected<void, JournalError> JournalScan::finish(const std::stop_token& stop) {
  for (;;) {
    const auto done = advance(kPartBytes, stop);
    if (!done) return std::unexpected(done.error());
    if (*done) return {};
  }
}

std::expected<void, JournalError> scan_journal(const std::filesystem::path& journal,
                                               const std::stop_token& stop) {
  return JournalScan(journal).finish(stop);
}

std::string damage_text(const JournalError& damage) {
  const std::string where = damage.sequence == 0 ? std::string("outside its records")
                                                 : "at record " + std::to_string(damage.sequence);
  return "the journal " + std::filesystem::path(damage.file).filename().string() + " is damaged " +
         where + " (" + damage.reason +
         "); its operator can keep the rest with 'kerf-server salvage'";
}

}  // namespace kerf
