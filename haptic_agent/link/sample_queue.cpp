// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/link/sample_queue.h"

#include <algorithm>
#include <array>

#include "kernel/math/vec3.h"

namespace kerf::agent {
namespace {

bool cuts(const wire::MotionSample& sample) noexcept {
  return (sample.buttons & wire::kButtonCutting) != 0;
}

/// Returns true if the samples between `from` and `to` may be dropped: the motion is one cut with
/// one tool, and the tip and axis of each sample are on the chord.
bool is_chord(const std::deque<wire::MotionSample>& samples, std::size_t from, std::size_t to) {
  const wire::MotionSample& a = samples[from];
  const wire::MotionSample& c = samples[to];
  if (!cuts(c) || c.tool_id != a.tool_id) return false;
  const Vec3 start = a.tip_mm;
  const Vec3 chord = c.tip_mm - start;
  const double square = dot(chord, chord);
  const Vec3 axis(a.axis);
  const Vec3 turn = Vec3(c.axis) - axis;
  for (std::size_t i = from + 1; i < to; ++i) {
    const wire::MotionSample& b = samples[i];
    if (!cuts(b) || b.agent_sequence != 0 || b.tool_id != a.tool_id) return false;
    const Vec3 offset = b.tip_mm - start;
    const double part = square > 0 ? std::clamp(dot(offset, chord) / square, 0.0, 1.0) : 0.0;
    if (length(offset - chord * part) > SampleQueue::kChordMm) return false;
    if (length(Vec3(b.axis) - axis - turn * part) > SampleQueue::kChordRad) return false;
  }
  return true;
}

}  // namespace

void SampleQueue::push(const wire::MotionSample& sample) {
  samples_.push_back(sample);
  samples_.back().agent_sequence = 0;
  ++fresh_;
  if (unsent() > kMergeAbove && fresh_ >= kMergeAbove) {
    merge_air();
    merge_straight();
    fresh_ = 0;
  }
  if (samples_.size() > kMaxKept + returned_) drop_oldest();
}

wire::MotionBatch SampleQueue::take(std::size_t most) {
  wire::MotionBatch batch;
  const std::size_t capacity = std::min<std::size_t>(most, wire::kMaxSamplesPerMotion);
  while (batch.count < capacity && next_ < samples_.size()) {
    wire::MotionSample& sample = samples_[next_];
    if (!in_window(sample)) break;
    if (batch.count > 0 && sample.tool_id != batch.samples[0].tool_id) break;
    ++next_;
    if (sample.agent_sequence == 0) {
      sample.agent_sequence = ++last_number_;
    } else {
      ++resent_;
    }
    connection_has_ = std::max(connection_has_, sample.agent_sequence);
    batch.samples[batch.count++] = sample;
  }
  return batch;
}

SampleQueue::Repeating SampleQueue::take_repeating(std::size_t most, std::uint32_t tool_id) {
  // Samples sent before go_back may have been answered since.
  next_ = std::max(next_, first_unanswered());
  Repeating out;
  const std::size_t start = next_;
  while (out.batch.count < kNewPerDatagram && next_ < samples_.size()) {
    wire::MotionSample& sample = samples_[next_];
    const bool numbered = sample.agent_sequence != 0;
    const bool fresh = !numbered || sample.agent_sequence > connection_has_;
    if (fresh && out.fresh == most) break;
    if (!in_window(sample) || sample.tool_id != tool_id) break;
    ++next_;
    if (numbered) {
      ++resent_;
    } else {
      sample.agent_sequence = ++last_number_;
    }
    if (fresh) {
      connection_has_ = sample.agent_sequence;
      ++out.fresh;
    }
    out.batch.samples[out.batch.count++] = sample;
  }
  out.due = out.batch.count;
  if (out.due > 0) prepend_unanswered(out.batch, start);
  return out;
}

/// Inserts the unanswered samples before `end` in front of the batch.
void SampleQueue::prepend_unanswered(wire::MotionBatch& batch, std::size_t end) {
  std::size_t from = end;
  while (from > 0 && end - from + batch.count < wire::kMaxSamplesPerMotion &&
         samples_[from - 1].agent_sequence > answered_ &&
         samples_[from - 1].tool_id == batch.samples[0].tool_id) {
    --from;
  }
  const auto repeats = static_cast<std::uint32_t>(end - from);
  std::shift_right(batch.samples.begin(), batch.samples.begin() + batch.count + repeats, repeats);
  for (std::uint32_t i = 0; i < repeats; ++i) batch.samples[i] = samples_[from + i];
  batch.count += repeats;
  repeated_ += repeats;
}

std::size_t SampleQueue::first_unanswered() const noexcept {
  std::size_t at = 0;
  // Samples that were never sent have no number yet.
  while (at < samples_.size() && samples_[at].agent_sequence != 0 &&
         samples_[at].agent_sequence <= answered_) {
    ++at;
  }
  return at;
}

void SampleQueue::go_back() noexcept { next_ = std::min(next_, first_unanswered()); }

void SampleQueue::answered(std::uint64_t agent_sequence) {
  if (agent_sequence > last_number_ || agent_sequence <= answered_) return;
  answered_ = agent_sequence;
  // After a reconnection the server may answer a number that it received on the old connection.
  while (samples_.size() > 1 && next_ > 1 && samples_[1].agent_sequence != 0 &&
         samples_[1].agent_sequence <= answered_) {
    release_first();
    --next_;
  }
}

/// Removes the first sample, or keeps it until it is durable.
void SampleQueue::release_first() {
  if (keeps_) {
    kept_.push_back(samples_.front());
    if (kept_.size() > kMaxNotDurable) {
      kept_.pop_front();
      ++given_up_;
    }
  } else {
    kept_.clear();
  }
  samples_.pop_front();
  if (returned_ > 0) --returned_;
}

void SampleQueue::durable(std::uint64_t agent_sequence) {
  if (agent_sequence > last_number_ || agent_sequence <= durable_) return;
  durable_ = agent_sequence;
  // The newest durable one is the start of the first motion after it.
  while (!kept_.empty()) {
    const std::uint64_t second =
        kept_.size() > 1 ? kept_[1].agent_sequence : samples_.front().agent_sequence;
    if (second == 0 || second > durable_) break;
    kept_.pop_front();
  }
}

void SampleQueue::rewind(std::uint64_t server_has) {
  const std::uint64_t from = std::max(server_has, durable_);
  connection_has_ = 0;
  next_ = samples_.size();
  answered(from);
  next_ = 0;
  if (!kept_.empty()) answered_ = std::min(answered_, from);
  // A first sample without a number was never sent, so samples before it were dropped.
  while (!kept_.empty() &&
         (samples_.front().agent_sequence == 0 || samples_.front().agent_sequence > from)) {
    samples_.push_front(kept_.back());
    kept_.pop_back();
    ++returned_;
  }
}

std::uint64_t SampleQueue::not_durable() const noexcept {
  return keeps_ && answered_ > durable_ ? answered_ - durable_ : 0;
}

bool SampleQueue::in_window(const wire::MotionSample& sample) const noexcept {
  for (std::size_t i = 0; i < next_; ++i) {
    if (samples_[i].agent_sequence <= answered_) continue;
    return sample.time_us <= samples_[i].time_us + kWindowUs + rtt_us_;
  }
  return true;
}

bool SampleQueue::settled() const noexcept {
  return unsent() == 0 && (samples_.empty() || samples_.back().agent_sequence <= answered_);
}

std::uint64_t SampleQueue::unanswered() const noexcept {
  return static_cast<std::uint64_t>(std::ranges::count_if(samples_, [&](const auto& sample) {
    return sample.agent_sequence == 0 || sample.agent_sequence > answered_;
  }));
}

std::optional<std::uint32_t> SampleQueue::next_tool() const noexcept {
  if (next_ >= samples_.size()) return std::nullopt;
  return samples_[next_].tool_id;
}

std::size_t SampleQueue::first_fresh() const noexcept {
  return std::max(next_, samples_.size() - std::min(samples_.size(), fresh_));
}

void SampleQueue::merge_air() {
  // A sample through the air may merge with one considered before, because its path does not
  // matter.
  const std::size_t start = std::max(next_, first_fresh() - (first_fresh() > 0 ? 1 : 0));
  std::size_t keep = start;
  for (std::size_t at = start; at < samples_.size(); ++at) {
    const wire::MotionSample& sample = samples_[at];
    const bool merges = sample.agent_sequence == 0 && at + 1 < samples_.size() && !cuts(sample) &&
                        !cuts(samples_[at + 1]) && sample.tool_id == samples_[at + 1].tool_id;
    if (!merges) samples_[keep++] = sample;
  }
  const std::size_t merged = samples_.size() - keep;
  merged_air_ += merged;
  fresh_ -= std::min(fresh_, merged);
  samples_.resize(keep);
}

void SampleQueue::merge_straight() {
  std::size_t keep = first_fresh();
  for (std::size_t at = keep; at < samples_.size();) {
    samples_[keep++] = samples_[at];
    // `at`: start of a chord; `end`: the farthest sample at which it may end.
    std::size_t end = at + 1;
    while (end + 1 < samples_.size() && end + 1 - at <= kLongestChord &&
           is_chord(samples_, at, end + 1)) {
      ++end;
    }
    merged_cuts_ += end - at - 1;
    at = end;
  }
  samples_.resize(keep);
}

void SampleQueue::thin_cuts() {
  const auto first = samples_.begin() + static_cast<std::ptrdiff_t>(next_);
  auto keep = first;
  bool dropped = true;
  for (auto at = first; at != samples_.end(); ++at) {
    const auto after = std::next(at);
    // Never drop two in a row, and only where the motions before and after are cuts of one tool.
    const bool thins = !dropped && at->agent_sequence == 0 && after != samples_.end() &&
                       cuts(*at) && cuts(*after) && at->tool_id == after->tool_id;
    dropped = thins;
    if (thins) {
      ++thinned_cuts_;
    } else {
      *keep++ = *at;
    }
  }
  samples_.erase(keep, samples_.end());
}

void SampleQueue::drop_oldest() {
  merge_air();
  if (samples_.size() > kMaxKept / 2) thin_cuts();
  while (samples_.size() > kMaxKept + returned_) {
    if (returned_ == 0) {
      drop_first();
    } else if (!drop_unsent()) {
      return;
    }
  }
}

/// Removes the first sample. An answered one is kept until it is durable. After an unanswered one
/// the tool moves to the next without cutting.
void SampleQueue::drop_first() {
  if (next_ > 0) --next_;
  const std::uint64_t number = samples_.front().agent_sequence;
  if (number != 0 && number <= answered_) return release_first();
  samples_.pop_front();
  samples_.front().buttons &= ~wire::kButtonCutting;
  ++forgotten_;
}

/// Drops the oldest sample that was never sent. Returns false if there is none. The tool moves to
/// the next one without cutting.
bool SampleQueue::drop_unsent() {
  const auto oldest =
      std::ranges::find(samples_, std::uint64_t{0}, &wire::MotionSample::agent_sequence);
  if (oldest == samples_.end()) return false;
  const auto next = samples_.erase(oldest);
  if (next != samples_.end()) next->buttons &= ~wire::kButtonCutting;
  ++forgotten_;
  return true;
}

}  // namespace kerf::agent
