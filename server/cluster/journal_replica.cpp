// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/journal_replica.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "server/log/log.h"
#include "server/platform/random.h"

namespace kerf {
namespace {

/// Minimum interval between two changes. Commits in between are batched.
constexpr std::chrono::milliseconds kGather{20};
/// Time until a failed change is retried.
constexpr std::chrono::milliseconds kRetry{250};
/// Time until the replica checks again whether its journal continues the stream.
constexpr std::chrono::milliseconds kConflictRetry{5000};

/// Niceness of the replicas' threads, below that of carving threads.
constexpr int kNiceness = 2;

}  // namespace

JournalReplica::JournalReplica(NatsConnection& nats, Source source, int replicas,
                               std::function<void(const CopyState&)> report)
    : nats_(nats),
      source_(std::move(source)),
      replicas_(replicas),
      report_(std::move(report)),
      changes_(source_.journal),
      writer_(random_number()),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

JournalReplica::~JournalReplica() = default;  // stops and joins the thread

void JournalReplica::wake() {
  {
    const std::lock_guard lock(mutex_);
    woken_ = true;
  }
  wake_.notify_all();
}

bool JournalReplica::finish(Clock::time_point end) {
  std::unique_lock lock(mutex_);
  finishing_ = woken_ = true;
  wake_.notify_all();
  wake_.wait_until(lock, end, [&] { return finished_; });
  thread_.request_stop();
  return finished_;
}

void JournalReplica::run(const std::stop_token& stop) {
  // Fails in a process of a higher niceness, which the thread then inherits.
  setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNiceness);
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    wake_.wait(lock, stop, [&] { return woken_; });
    if (stop.stop_requested()) return;
    woken_ = false;
    const bool is_last = finishing_;
    lock.unlock();
    const bool done = copy(stop);
    show();
    lock.lock();
    if (done && is_last) {
      finished_ = true;
      wake_.notify_all();
    }
    if (!done) woken_ = true;
    const auto pause = done ? kGather : is_conflict_ ? kConflictRetry : kRetry;
    wake_.wait_for(lock, stop, pause, [&] { return finishing_ && !is_last; });
  }
}

bool JournalReplica::fail(const std::string& reason) {
  state_.fault = reason;
  return false;
}

bool JournalReplica::refuse(const std::string& reason) {
  is_conflict_ = true;
  return fail(reason);
}

void JournalReplica::show() {
  if (state_ == shown_) return;
  if (state_.fault != shown_.fault) {
    const std::string session = "session " + source_.session + ": ";
    if (state_.fault.empty()) {
      log::info(session + "its journal is copied to NATS, after record " +
                std::to_string(state_.record));
    } else {
      log::warn(session + "its journal is not copied to NATS: " + state_.fault);
    }
  }
  shown_ = state_;
  report_(state_);
}

bool JournalReplica::copy(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    if (!has_begun_ && !begin()) return false;
    if (!change_) {
      const std::uint64_t commits = source_.commits();
      auto next = changes_.next();
      if (!next) return fail(describe(next.error()));
      state_.fault.clear();
      if (!*next) {
        state_.commits = commits;
        return true;
      }
      change_ = **std::move(next);
      change_commits_ = change_->is_whole ? std::optional(commits) : state_.commits;
      ++change_number_;
      next_part_ = 0;
    }
    if (!send()) return false;
    state_.record = changes_.position().record;
    state_.commits = change_commits_;
    show();
  }
  return true;
}

bool JournalReplica::begin() {
  is_conflict_ = false;
  const std::string stream = copy_stream(source_.session);
  const std::string subject = copy_subject(source_.session);
  if (const auto made = nats_.make_stream(stream, subject, replicas_); !made) {
    return fail(made.error().reason);
  }
  const auto last = nats_.last_message(stream, subject);
  if (!last) return fail(last.error().reason);
  last_message_ = *last ? (*last)->sequence : 0;
  if (*last) {
    const auto frame = decode_frame((*last)->bytes);
    if (!frame) return refuse("the stream " + stream + " holds something else");
    if (!continue_after(*frame)) return false;
  } else {
    change_.reset();
    (void)changes_.begin({});
    state_.record = 0;
    state_.commits.reset();
  }
  has_begun_ = true;
  state_.fault.clear();
  return true;
}

bool JournalReplica::continue_after(const Frame& last) {
  const FrameHead& head = last.head;
  const bool is_own = head.writer == writer_;
  if (is_own && change_ && head.change == change_number_) {  // an acknowledgement was lost
    next_part_ = head.part + 1;
    return true;
  }
  if (is_own && change_ && head.change + 1 == change_number_ && head.is_last()) {
    next_part_ = 0;
    return true;
  }
  // Otherwise the stream is of an earlier process, or NATS has lost messages in a crash.
  if (!is_own && head.epoch >= source_.epoch) {
    return refuse("another server continues the session: its epoch is " +
                  std::to_string(head.epoch) + ", that of this journal " +
                  std::to_string(source_.epoch));
  }
  change_.reset();
  const auto continues = changes_.begin(head.position());
  if (!continues) return fail(describe(continues.error()));
  if (!*continues) {
    return refuse(
        "the copy has records that this journal does not have: fetch it, or remove it with "
        "kerf-server forget " +
        source_.session);
  }
  state_.record = head.position().record;
  state_.commits.reset();
  return true;
}

bool JournalReplica::send() {
  const std::vector<std::byte>& rows = change_->rows;
  const std::size_t parts = std::max<std::size_t>(1, (rows.size() + kFrameBytes - 1) / kFrameBytes);
  FrameHead head{.epoch = source_.epoch,
                 .writer = writer_,
                 .change = change_number_,
                 .part = 0,
                 .parts = static_cast<std::uint32_t>(parts),
                 .is_whole = change_->is_whole,
                 .before = change_->before,
                 .after = change_->after};
  while (next_part_ < parts) {
    head.part = next_part_;
    const std::size_t first = next_part_ * kFrameBytes;
    const std::size_t count = std::min(kFrameBytes, rows.size() - first);
    const auto bytes = encode_frame(head, std::span(rows).subspan(first, count));
    const std::string id = source_.session + "/" + std::to_string(source_.epoch) + "/" +
                           std::to_string(writer_) + "/" + std::to_string(change_number_) + "/" +
                           std::to_string(next_part_);
    const auto stored = nats_.publish(copy_subject(source_.session), bytes, id, last_message_);
    if (!stored) {
      // The outcome may be unknown, so the stream is read and the change is sent again.
      has_begun_ = false;
      return fail(stored.error().reason);
    }
    last_message_ = *stored;
    ++next_part_;
  }
  change_.reset();
  return true;
}

}  // namespace kerf
