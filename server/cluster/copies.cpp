// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/copies.h"

#include <cstdio>
#include <optional>
#include <utility>

#include "server/cluster/nats_address.h"
#include "server/cluster/snapshot_copy.h"

namespace kerf {
namespace {

int report(const std::string& error) {
  std::fprintf(stderr, "kerf-server: %s\n", error.c_str());
  return 1;
}

std::expected<NatsConnection, std::string> connect(const std::string& url) {
  if (url.empty()) return std::unexpected("--nats URL is missing");
  auto nats = NatsConnection::open(url, "kerf-server copies");
  if (!nats) return std::unexpected(without_credentials(url) + ": " + nats.error().reason);
  if (!nats->is_connected())
    return std::unexpected(without_credentials(url) + ": NATS cannot be reached");
  return *std::move(nats);
}

std::string describe(const NatsError& error, const std::string& session) {
  if (error.code != NatsErrorCode::kAbsent) return error.reason;
  return "there is no copy of session " + session + "; kerf-server copies lists them";
}

}  // namespace

std::expected<std::optional<JournalChange>, std::string> FrameJoiner::add(
    std::span<const std::byte> message) {
  const auto frame = decode_frame(message);
  if (!frame) return std::unexpected("a message is damaged, or of another version of Kerf");
  const FrameHead& head = frame->head;
  if (head_ && head.epoch < head_->epoch) {
    return std::unexpected("a message of epoch " + std::to_string(head.epoch) +
                           " follows one of epoch " + std::to_string(head_->epoch));
  }
  const bool continues = head_ && head_->writer == head.writer && head_->change == head.change &&
                         head.part == head_->part + 1;
  if (head.part == 0) rows_.clear();
  if (head.part != 0 && !continues) return std::unexpected("a part of a change is missing");
  rows_.insert(rows_.end(), frame->rows.begin(), frame->rows.end());
  head_ = head;
  if (!head.is_last()) return std::nullopt;
  JournalChange change;
  change.before = head.before;
  change.after = head.after;
  change.is_whole = head.is_whole;
  change.rows = std::exchange(rows_, {});
  return change;
}

std::expected<std::optional<CopyEnd>, std::string> end_of_copy(NatsConnection& nats,
                                                               const std::string& session) {
  const auto last = nats.last_message(copy_stream(session), copy_subject(session));
  if (!last && last.error().code == NatsErrorCode::kAbsent) return std::nullopt;
  if (!last) return std::unexpected(last.error().reason);
  if (!*last) return std::nullopt;
  const auto frame = decode_frame((*last)->bytes);
  if (!frame) return std::unexpected("the copy is damaged, or of another version of Kerf");
  return CopyEnd{(*last)->sequence, frame->head};
}

std::expected<FetchedCopy, std::string> fetch_copy(NatsConnection& nats, const std::string& session,
                                                   const std::filesystem::path& to) {
  std::uint64_t whole = 0;
  auto copy = JournalCopy::create(to);
  if (!copy) return std::unexpected(describe(copy.error()));
  FrameJoiner joiner;
  std::string fault;
  const auto take = [&](const StreamMessage& message) {
    const auto change = joiner.add(message.bytes);
    if (!change) {
      fault = "message " + std::to_string(message.sequence) + ": " + change.error();
    } else if (*change) {
      if (const auto done = copy->apply(**change); !done) fault = describe(done.error());
      if ((*change)->is_whole) whole = message.sequence;
    }
    return fault.empty();
  };
  const auto read = nats.read(copy_stream(session), copy_subject(session), take);
  if (!read) return std::unexpected(describe(read.error(), session));
  if (!fault.empty()) return std::unexpected(fault);
  const auto position = copy->finish();
  if (!position) return std::unexpected(describe(position.error()));
  return FetchedCopy{*position, whole};
}

int print_copies(const std::string& url) {
  auto nats = connect(url);
  if (!nats) return report(nats.error());
  const auto streams = nats->streams();
  if (!streams) return report(streams.error().reason);
  for (const std::string& stream : *streams) {
    const auto session = session_of_stream(stream);
    if (!session) continue;
    const auto last = nats->last_message(stream, copy_subject(*session));
    if (!last) return report(last.error().reason);
    const auto frame = *last ? decode_frame((*last)->bytes) : std::nullopt;
    if (frame) {
      std::printf("%s: %llu records, epoch %u\n", session->c_str(),
                  static_cast<unsigned long long>(frame->head.position().record),
                  frame->head.epoch);
    } else {
      std::printf("%s: empty, or of another version of Kerf\n", session->c_str());
    }
  }
  return 0;
}

int fetch_journal(const std::string& url, const std::string& session,
                  const std::filesystem::path& to) {
  auto nats = connect(url);
  if (!nats) return report(nats.error());
  const auto fetched = fetch_copy(*nats, session, to);
  if (!fetched) return report(fetched.error());
  // Without a snapshot the first start replays all records.
  const auto snapshot = fetch_snapshots(*nats, session, kAnyEpoch, to);
  if (!snapshot) {
    std::fprintf(stderr, "kerf-server: no snapshot is fetched: %s\n", snapshot.error().c_str());
  }
  std::printf("%s: %llu records\n", to.c_str(),
              static_cast<unsigned long long>(fetched->position.record));
  return 0;
}

int forget_copy(const std::string& url, const std::string& session) {
  auto nats = connect(url);
  if (!nats) return report(nats.error());
  const auto snapshots = nats->delete_stream(snapshot_stream(session));
  if (!snapshots && snapshots.error().code != NatsErrorCode::kAbsent) {
    return report(snapshots.error().reason);
  }
  const auto done = nats->delete_stream(copy_stream(session));
  if (!done) return report(describe(done.error(), session));
  std::printf("%s: its copy is deleted\n", session.c_str());
  return 0;
}

}  // namespace kerf
