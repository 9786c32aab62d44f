#include "haptic_agent/link/sample_queue.h"

#include <algorithm>

namespace kerf::agent {
namespace {

bool cuts(const wire::MotionSample& sample) noexcept {
  return (sample.buttons & wire::kButtonCutting) != 0;
}

}  // namespace

void SampleQueue::push(const wire::MotionSample& sample) {
  samples_.push_back(sample);
  samples_.back().agent_sequence = 0;
  if (unsent() > merge_above_) {
    merge_air();
    // The next pass waits until as many again have come, so that each sample is looked at a few
    // times only.
    merge_above_ = std::max(kMergeAirAbove, 2 * unsent());
  }
  if (samples_.size() > kMostKept) make_room();
}

wire::MotionBatch SampleQueue::take(std::size_t most) {
  wire::MotionBatch batch;
  const std::size_t room = std::min<std::size_t>(most, wire::kMaxSamplesPerMotion);
  while (batch.count < room && next_ < samples_.size()) {
    wire::MotionSample& sample = samples_[next_];
    if (batch.count > 0 && sample.tool_id != batch.samples[0].tool_id) break;
    ++next_;
    if (sample.agent_sequence == 0) {
      sample.agent_sequence = ++last_number_;
    } else {
      ++resent_;
    }
    batch.samples[batch.count++] = sample;
  }
  if (unsent() <= kMergeAirAbove) merge_above_ = kMergeAirAbove;
  return batch;
}

void SampleQueue::answered(std::uint64_t agent_sequence) {
  if (agent_sequence > last_number_ || agent_sequence <= answered_) return;
  answered_ = agent_sequence;
  // A server may answer, after a reconnection, a number that it got on the connection before.
  while (samples_.size() > 1 && next_ > 1 && samples_[1].agent_sequence != 0 &&
         samples_[1].agent_sequence <= answered_) {
    samples_.pop_front();
    --next_;
  }
}

void SampleQueue::rewind() noexcept { next_ = 0; }

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

void SampleQueue::merge_air() {
  const auto first = samples_.begin() + static_cast<std::ptrdiff_t>(next_);
  auto keep = first;
  for (auto at = first; at != samples_.end(); ++at) {
    const auto after = std::next(at);
    const bool merges = at->agent_sequence == 0 && after != samples_.end() && !cuts(*at) &&
                        !cuts(*after) && at->tool_id == after->tool_id;
    if (merges) {
      ++merged_air_;
    } else {
      *keep++ = *at;
    }
  }
  samples_.erase(keep, samples_.end());
}

void SampleQueue::thin_cuts() {
  const auto first = samples_.begin() + static_cast<std::ptrdiff_t>(next_);
  auto keep = first;
  bool left_out = true;
  for (auto at = first; at != samples_.end(); ++at) {
    const auto after = std::next(at);
    // Never two in a row, and only where the motion before and the one after are of one kind.
    const bool thins = !left_out && at->agent_sequence == 0 && after != samples_.end() &&
                       cuts(*at) && cuts(*after) && at->tool_id == after->tool_id;
    left_out = thins;
    if (thins) {
      ++thinned_cuts_;
    } else {
      *keep++ = *at;
    }
  }
  samples_.erase(keep, samples_.end());
}

void SampleQueue::make_room() {
  merge_air();
  if (samples_.size() > kMostKept / 2) thin_cuts();
  while (samples_.size() > kMostKept) {
    samples_.pop_front();
    if (next_ > 0) --next_;
    ++forgotten_;
  }
}

}  // namespace kerf::agent
