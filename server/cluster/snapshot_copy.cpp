// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/snapshot_copy.h"

#include <fstream>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "server/cluster/change_frame.h"
#include "server/cluster/copies.h"
#include "server/platform/random.h"
#include "server/store/block_snapshot.h"
#include "server/store/chunk_file.h"

namespace kerf {
namespace {

/// A snapshot is sent as a change whose rows are the bytes of its file.
CopyPosition position_of(std::uint64_t record) { return {.record = record}; }

/// Reads a file that is only ever replaced by rename.
class ReadFile {
 public:
  explicit ReadFile(const std::filesystem::path& file) : in_(file, std::ios::binary) {
    in_.seekg(0, std::ios::end);
    bytes_ = in_ ? static_cast<std::size_t>(in_.tellg()) : 0;
    in_.seekg(0);
  }
  std::size_t bytes() const { return bytes_; }
  /// The next bytes, at most `most`, or empty after an error.
  std::span<const std::byte> next(std::size_t most) {
    part_.resize(most);
    in_.read(reinterpret_cast<char*>(part_.data()), static_cast<std::streamsize>(most));
    return std::span(part_).first(static_cast<std::size_t>(in_.gcount()));
  }

 private:
  std::ifstream in_;
  std::size_t bytes_ = 0;
  std::vector<std::byte> part_;
};

std::uint64_t record_of(const std::filesystem::path& snapshot) {
  const auto head = read_snapshot_head(snapshot);
  return head ? head->sequence : 0;
}

/// Makes `bytes` the newest snapshot of a journal. The present one becomes the previous one.
std::expected<void, std::string> put_newest(const std::filesystem::path& journal,
                                            std::span<const std::byte> bytes) {
  const auto newest = snapshot_file(journal), unfinished = unfinished_file(newest);
  {
    std::ofstream out(unfinished, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) return std::unexpected(unfinished.string() + " cannot be written");
  }
  std::error_code error;
  std::filesystem::rename(newest, previous_snapshot_file(journal), error);  // if it exists
  std::filesystem::rename(unfinished, newest, error);
  if (error) return std::unexpected(newest.string() + ": " + error.message());
  return {};
}

}  // namespace

std::string snapshot_stream(const std::string& session) { return "KERF_SNAPSHOT_" + session; }
std::string snapshot_subject(const std::string& session) { return "kerf.snapshot." + session; }

SnapshotCopy::SnapshotCopy(NatsConnection& nats, Source source, int replicas)
    : nats_(nats), source_(std::move(source)), replicas_(replicas), writer_(random_number()) {}

/// Reads the end of the stream, and whether it is of an earlier epoch.
std::expected<void, std::string> SnapshotCopy::begin() {
  const std::string stream = snapshot_stream(source_.session);
  const std::string subject = snapshot_subject(source_.session);
  if (const auto made = nats_.make_stream(stream, subject, replicas_); !made) {
    return std::unexpected(made.error().reason);
  }
  const auto last = nats_.last_message(stream, subject);
  if (!last) return std::unexpected(last.error().reason);
  last_message_ = *last ? (*last)->sequence : 0;
  const auto frame = *last ? decode_frame((*last)->bytes) : std::nullopt;
  if (frame && frame->head.writer != writer_ && frame->head.epoch >= source_.epoch) {
    return std::unexpected("another server continues the session in epoch " +
                           std::to_string(frame->head.epoch));
  }
  kept_from_ = 0;
  record_ = frame ? frame->head.position().record : 0;
  if (frame && frame->head.is_last()) kept_from_ = last_message_ - frame->head.part;
  has_begun_ = true;
  return {};
}

std::expected<bool, std::string> SnapshotCopy::copy(std::uint64_t copied,
                                                    const std::stop_token& stop) {
  std::error_code absent;
  const auto file = snapshot_file(source_.journal);
  const auto written = std::filesystem::last_write_time(file, absent);
  if (absent || done_ == written) return false;
  if (!has_begun_) {
    if (auto ok = begin(); !ok) return std::unexpected(ok.error());
  }
  const std::uint64_t record = record_of(file);
  if (record > copied) return false;  // a takeover could not use it
  if (record > record_) {
    const auto stored = store(record, stop);
    if (!stored || !*stored) return stored;
    done_ = written;
    return true;
  }
  done_ = written;
  return false;
}

std::expected<bool, std::string> SnapshotCopy::store(std::uint64_t record,
                                                     const std::stop_token& stop) {
  ReadFile file(snapshot_file(source_.journal));
  if (file.bytes() == 0) return false;  // it has been replaced since
  const std::size_t parts = (file.bytes() + kFrameBytes - 1) / kFrameBytes;
  FrameHead head{.epoch = source_.epoch,
                 .writer = writer_,
                 .change = ++number_,
                 .part = 0,
                 .parts = static_cast<std::uint32_t>(parts),
                 .is_whole = true,
                 .before = position_of(record_),
                 .after = position_of(record)};
  const std::uint64_t first = last_message_ + 1;
  for (; head.part < head.parts; ++head.part) {
    if (stop.stop_requested()) return false;
    const auto bytes = file.next(kFrameBytes);
    const std::string id = "snapshot/" + source_.session + "/" + std::to_string(writer_) + "/" +
                           std::to_string(number_) + "/" + std::to_string(head.part);
    const auto stored = nats_.publish(snapshot_subject(source_.session), encode_frame(head, bytes),
                                      id, last_message_);
    if (!stored) {
      has_begun_ = false;  // its outcome may be unknown, so the stream is read
      return std::unexpected(stored.error().reason);
    }
    last_message_ = *stored;
  }
  record_ = record;
  const std::uint64_t previous = std::exchange(kept_from_, first);
  // Keeps the previous one, in case the newest cannot be used.
  (void)nats_.purge(snapshot_stream(source_.session), previous != 0 ? previous : first);
  return true;
}

std::expected<std::uint64_t, std::string> fetch_snapshots(NatsConnection& nats,
                                                          const std::string& session,
                                                          std::uint32_t epoch,
                                                          const std::filesystem::path& journal) {
  std::uint64_t newest = record_of(snapshot_file(journal));
  const std::string stream = snapshot_stream(session), subject = snapshot_subject(session);
  const auto last = nats.last_message(stream, subject);
  if (!last && last.error().code == NatsErrorCode::kAbsent) return newest;
  if (!last) return std::unexpected(last.error().reason);
  const auto end = *last ? decode_frame((*last)->bytes) : std::nullopt;
  if (*last && !end) return std::unexpected("its last message is damaged");
  if (!end || end->head.position().record <= newest) return newest;
  if (end->head.epoch >= epoch) {
    return std::unexpected("they are of epoch " + std::to_string(end->head.epoch) +
                           ", which has not ended");
  }
  FrameJoiner joiner;
  std::string fault;
  const auto take = [&](const StreamMessage& message) {
    const auto snapshot = joiner.add(message.bytes);
    if (!snapshot) {  // another one may be whole
      fault = "message " + std::to_string(message.sequence) + ": " + snapshot.error();
      return true;
    }
    if (!*snapshot || (*snapshot)->after.record <= newest) return true;
    if (const auto put = put_newest(journal, (*snapshot)->rows); !put) {
      fault = put.error();
      return false;
    }
    newest = (*snapshot)->after.record;
    return true;
  };
  const auto read = nats.read(stream, subject, take);
  if (!read) return std::unexpected(read.error().reason);
  if (newest < end->head.position().record) {
    return std::unexpected(fault.empty() ? "the newest one has no beginning" : fault);
  }
  return newest;
}

}  // namespace kerf
