// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_survey.h"

#include <algorithm>
#include <utility>

namespace kerf {

void ProgramTotals::add(const ProgramMotion& motion) {
  ++motions;
  duration_s += motion.duration_s;
  if (!tools.empty() && tools.back().tool == motion.tool) return;
  if (std::ranges::find(tools, motion.tool, &Use::tool) == tools.end())
    tools.push_back({motion.tool, motion.line});
}

void ProgramSurvey::begin() {
  totals_ = {};
  duration_s_ = 0;
  path_ = PathCollector(points_max_);
  machine_ = MachineTime(dynamics_);
  sampler_.reset();
  if (rate_hz_) sampler_.emplace(*rate_hz_);
}

void ProgramSurvey::visit(std::span<const ProgramMotion> motions) {
  for (const ProgramMotion& motion : motions) {
    duration_s_ += motion.duration_s;
    path_.add(motion);
    machine_.add(motion);
    // One motion may have any number of samples.
    if (sampler_ && duration_s_ * *rate_hz_ >= kSamplesMax) sampler_.reset();
    if (sampler_) {
      take_samples();
      sampler_->add(motion);
    } else if (!rate_hz_) {
      totals_.add(motion);
    }
  }
}

void ProgramSurvey::take_samples() {
  while (sampler_->can_sample()) {
    sampler_->sample(samples_);
    for (const ProgramMotion& sample : samples_) totals_.add(sample);
    samples_.clear();
  }
}

ProgramTotals ProgramSurvey::totals() {
  if (sampler_) {
    sampler_->end();
    take_samples();
  }
  return std::move(totals_);
}

MotionStream::MotionStream(std::unique_ptr<ProgramReader> reader, std::optional<double> rate_hz)
    : reader_(std::move(reader)) {
  if (rate_hz) sampler_.emplace(*rate_hz);
}

std::expected<bool, ProgramError> MotionStream::read() {
  if (next() != nullptr) return true;
  ready_.clear();
  taken_ = 0;
  if (sampler_ && (sampled_ < read_.size() || sampler_->can_sample() || !more_)) {
    sample();
    return next() != nullptr || more_;
  }
  if (!more_) return false;
  const auto step = reader_->step();
  if (!step) return std::unexpected(step.error());
  more_ = *step;
  std::vector<ProgramMotion>& motions = sampler_ ? read_ : ready_;
  motions.swap(reader_->program().motions);
  reader_->program().motions.clear();
  reader_->program().tool_changes.clear();
  sampled_ = 0;
  return next() != nullptr || more_ || sampler_.has_value();
}

/// Makes a sample, or adds motions until one can be made.
void MotionStream::sample() {
  while (!sampler_->can_sample() && sampled_ < read_.size()) sampler_->add(read_[sampled_++]);
  if (!sampler_->can_sample() && !more_) sampler_->end();
  if (sampler_->can_sample()) sampler_->sample(ready_);
}

}  // namespace kerf
