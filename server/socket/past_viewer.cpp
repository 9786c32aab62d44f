// SPDX-License-Identifier: Apache-2.0
#include "server/socket/past_viewer.h"

#include <exception>
#include <utility>

#include "server/metrics/metrics.h"
#include "server/session/session_past_source.h"
#include "server/wire/codec.h"

namespace kerf::net {
namespace {

/// Time per turn of playing, because all viewers of the past share the thread.
constexpr std::chrono::milliseconds kTurn{15};
/// Longer pauses of the journal are skipped; ms.
constexpr std::int64_t kPauseMaxMs = 1000;
/// Minimum interval between two hashes during playback.
constexpr std::chrono::milliseconds kHashInterval{500};

}  // namespace

PastViewer::PastViewer(std::shared_ptr<Session> session, ViewerConversation* viewer,
                       PeerContext& context, std::optional<ViewerLook> look,
                       std::function<void(bool)> on_first)
    : viewer_(viewer),
      context_(context),
      on_first_(std::move(on_first)),
      side_(std::make_shared<Side>()) {
  side_->session = std::move(session);
  side_->first_look = look;
  side_->budget = viewer->budget();
  // Frames of the past have checksums and digests too.
  if (viewer->first_look().nodes == TileNodes::kVerified) side_->nodes = TileNodes::kVerified;
}

std::int64_t PastViewer::journal_clock() const {
  const std::chrono::duration<double, std::milli> played = Clock::now() - since_;
  return journal_ms_ + static_cast<std::int64_t>(played.count() * rate_);
}

void PastViewer::set_clock(std::int64_t journal_ms) {
  journal_ms_ = journal_ms;
  since_ = Clock::now();
}

void PastViewer::seek(const SeekMessage& seek) {
  set_clock(journal_clock());
  rate_ = seek.rate;
  if (seek.record) {
    stop_.request_stop();
    next_.record = seek.record;
  }
  next_.with_hash = true;
  start_job();
}

void PastViewer::acknowledge(std::uint64_t sequence) {
  next_.acks.push_back(sequence);
  start_job();
}

void PastViewer::look(const ViewerLook& look) {
  next_.look = look;
  start_job();
}

void PastViewer::set_budget(std::uint32_t bytes_per_s) {
  next_.budget = bytes_per_s;
  start_job();
}

void PastViewer::tick() {
  if (is_shown_ && (rate_ > 0 || waits_for_budget_)) start_job();
}

void PastViewer::end() {
  viewer_ = nullptr;
  stop_.request_stop();
}

void PastViewer::start_job() {
  if (job_runs_ || viewer_ == nullptr) return;
  if (rate_ > 0 && is_shown_ && !next_.record) {
    next_.until_ms = journal_clock();
    next_.with_hash = next_.with_hash || Clock::now() - hashed_ >= kHashInterval;
  }
  job_runs_ = true;
  stop_ = {};
  context_.past.post([self = shared_from_this(), side = side_, job = std::exchange(next_, {}),
                      stop = stop_.get_token()] {
    auto result = run_job(*side, job, stop);
    self->context_.viewers.post(
        [self, result = std::move(result)]() mutable { self->deliver(std::move(result)); });
  });
}

/// Brings the block to the record of the job.
void PastViewer::go(Side& side, const Job& job, const std::stop_token& stop, Result& result) {
  if (!side.block) {
    auto block = PastBlock::create(past_of(side.session));
    if (!block) return void(result.error = block.error());
    side.block = *std::move(block);
  }
  if (job.record) {
    const auto found = side.block->seek(*job.record, stop);
    if (!found) return void(result.error = found.error());
    result.has_no_record = !*found;
    result.has_moved = *found;
  } else if (job.until_ms) {
    const auto played = side.block->play({.ms = *job.until_ms}, kTurn, stop);
    if (!played) return void(result.error = played.error());
    result.is_late = played->is_late;
    result.next_ms = played->next_ms;
  }
}

/// Distinguishes damage of the journal, which persists, from temporary failures.
void PastViewer::explain(const Session& session, const std::stop_token& stop, Result& result) {
  const auto damage = session.past().damage_after(result.error, stop);
  if (!damage) return;
  result.is_damaged = true;
  result.error = damage_text(*damage);
}

PastViewer::Result PastViewer::run_job(Side& side, const Job& job, const std::stop_token& stop) {
  Result result;
  try {
    go(side, job, stop, result);
    if (!result.error.empty()) explain(*side.session, stop, result);
    if (job.look && !side.feed) side.first_look = job.look;
    if (job.budget && !side.feed) side.budget = *job.budget;
    if (side.feed || result.has_moved) serve(side, job, result);
  } catch (const std::exception& error) {  // e.g. not enough memory for another block
    result.error = error.what();
  }
  return result;
}

/// Builds the frames for one viewer of the past.
void PastViewer::serve(Side& side, const Job& job, Result& result) {
  PastBlock& block = *side.block;
  const std::vector<TileIndex> changed = block.take_changed();
  if (!side.feed) {
    side.feed = std::make_unique<TileFeed>(block.solid(), block.record());
    side.viewer = side.feed->add_viewer(side.first_look, side.nodes, side.budget);
  } else if (job.record || job.until_ms) {
    side.feed->note_change(block.solid(), changed, block.record());
  }
  for (const std::uint64_t sequence : job.acks) {
    result.has_bad_ack = !side.feed->ack(side.viewer, sequence) || result.has_bad_ack;
  }
  if (job.look) side.feed->look(side.viewer, *job.look);
  if (job.budget) side.feed->set_budget(side.viewer, *job.budget);
  const auto now = Clock::now();
  while (auto frame = side.feed->next_frame(side.viewer, now)) result.frames.push_back(*frame);
  result.state.sequence = result.state.motions = block.record();
  result.state.removed_mm3 = block.removed_mm3();
  result.state.past = PastPlace{block.record(), block.time_ms(), 0};
  const auto viewer_state = *side.feed->viewer_state(side.viewer);
  result.state.settled = viewer_state.sent;
  result.waits_for_budget = viewer_state.waits_for_budget;
  result.with_hash = job.with_hash;
  if (job.with_hash) result.state.hash = block.solid().hash();
  result.tools = block.tools();
  const auto stats = side.feed->stats();
  result.tiles = stats.tiles_meshed - side.counted.tiles_meshed;
  result.bytes = stats.bytes_composed - side.counted.bytes_composed;
  side.counted = stats;
}

void PastViewer::reject(const Result& result) {
  rate_ = 0;
  viewer_->reject_request(
      result.has_no_record
          ? Rejection{wire::ErrorCode::kBadMessage, "the session has no record of this number yet"}
          : Rejection{result.is_damaged ? wire::ErrorCode::kDamagedJournal : wire::ErrorCode::kBusy,
                      result.error});
}

void PastViewer::deliver(Result result) {
  job_runs_ = false;
  if (viewer_ == nullptr) return;
  context_.metrics.mesh_made(result.tiles, result.bytes);
  waits_for_budget_ = result.waits_for_budget;
  const bool has_failed = !result.error.empty() || result.has_no_record;
  // A job that the next seek has ended has not failed.
  if (has_failed && !next_.record) reject(result);
  if (!is_shown_ && result.state.past) {
    is_shown_ = true;
    on_first_(true);
  } else if (!is_shown_ && has_failed && !next_.record) {
    return on_first_(false);
  }
  if (result.has_bad_ack) viewer_->reject_ack();
  if (result.state.past) send(result);
  if (!next_.empty()) start_job();
}

void PastViewer::send(Result& result) {
  // The clock waits while the block is late, and skips long pauses.
  if (result.has_moved || result.is_late) set_clock(result.state.past->time_ms);
  if (result.next_ms > journal_clock() + kPauseMaxMs) set_clock(result.next_ms);
  for (FeedFrame& frame : result.frames) viewer_->send_mesh(std::move(frame));
  std::vector<std::byte> bytes(wire::encoded_bytes(result.tools));
  const wire::FrameStamp stamp{side_->session->epoch(), ++tools_sent_, to_us(Clock::now())};
  wire::encode(stamp, result.tools, bytes);
  viewer_->send_tools(std::make_shared<const std::vector<std::byte>>(std::move(bytes)));
  if (result.with_hash) {
    state_ = result.state;
    hashed_ = Clock::now();
  }
  if (state_.sequence != result.state.sequence) return;  // it has advanced since the last hash
  state_.settled = result.state.settled;
  state_.past = result.state.past;
  state_.past->rate = rate_;
  viewer_->send_state(state_);
}

}  // namespace kerf::net
