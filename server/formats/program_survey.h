// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "server/formats/feed_sampler.h"
#include "server/formats/machine_time.h"
#include "server/formats/program_path.h"
#include "server/formats/program_reader.h"

namespace kerf {

/// Totals of a program that are needed before it is carved.
struct ProgramTotals {
  std::size_t motions = 0;
  double duration_s = 0;  ///< at feed rate
  struct Use {
    ToolId tool = 0;
    std::uint32_t line = 0;  ///< of its first motion
  };
  std::vector<Use> tools;  ///< in the order of their first motions

  void add(const ProgramMotion& motion);
};

/// Collects totals and path of a program, with or without sampling, while it is read to its end.
class ProgramSurvey final : public ProgramVisitor {
 public:
  /// `rate_hz`: surveys the program resampled at this rate, as by sample_program. `stop` ends the
  /// reading.
  ProgramSurvey(std::size_t path_points_max, std::optional<double> rate_hz,
                const MachineDynamics& dynamics = {}, std::stop_token stop = {})
      : points_max_(path_points_max),
        rate_hz_(rate_hz),
        dynamics_(dynamics),
        path_(path_points_max),
        machine_(dynamics),
        stop_(std::move(stop)) {}

  void begin() override;
  void visit(std::span<const ProgramMotion> motions) override;
  bool is_stopped() const override { return stop_.stop_requested(); }
  /// Incomplete if there are kSamplesMax samples or more. Call once, at the end.
  ProgramTotals totals();
  /// The path without sampling. Call once.
  ProgramPath path() { return path_.take(); }
  /// The duration without sampling.
  double duration_s() const { return duration_s_; }
  /// The time on the machine, without sampling.
  const MachineTime& machine() const { return machine_; }
  /// Greatest distance of a corner from the sample that spans it.
  double corner_cut_mm() const { return sampler_ ? sampler_->corner_cut_mm() : 0; }

 private:
  void take_samples();

  std::size_t points_max_;
  std::optional<double> rate_hz_;
  MachineDynamics dynamics_;
  ProgramTotals totals_;
  PathCollector path_;
  std::optional<FeedSampler> sampler_;
  std::vector<ProgramMotion> samples_;
  double duration_s_ = 0;
  MachineTime machine_;
  std::stop_token stop_;
};

/// The motions of a program, or their samples, in order, read on demand.
class MotionStream {
 public:
  /// `rate_hz` as in ProgramSurvey.
  MotionStream(std::unique_ptr<ProgramReader> reader, std::optional<double> rate_hz);

  /// The next motion, or null if it must be read first, and at the end.
  const ProgramMotion* next() const { return taken_ < ready_.size() ? &ready_[taken_] : nullptr; }
  /// Reads some of the program if no motion is ready. Returns false at the end.
  std::expected<bool, ProgramError> read();
  /// Drops the next motion. Precondition: next() is not null.
  void pop() { ++taken_; }

 private:
  void sample();

  std::unique_ptr<ProgramReader> reader_;
  std::optional<FeedSampler> sampler_;
  std::vector<ProgramMotion> ready_, read_;  ///< to be taken; to be sampled
  std::size_t taken_ = 0, sampled_ = 0;      ///< of them
  bool more_ = true;                         ///< to read
};

}  // namespace kerf
