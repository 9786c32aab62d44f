// SPDX-License-Identifier: Apache-2.0
#include "server/session/program_job.h"

#include <memory>
#include <span>
#include <utility>

namespace kerf {
namespace {

/// Reads motions from a list.
class ListReader final : public ProgramReader {
 public:
  explicit ListReader(std::shared_ptr<const Program> list) : list_(std::move(list)) {}

  std::expected<bool, ProgramError> step() override {
    if (read_ < list_->motions.size()) program_.motions.push_back(list_->motions[read_++]);
    return read_ < list_->motions.size();
  }

 private:
  std::shared_ptr<const Program> list_;
  std::size_t read_ = 0;
};

}  // namespace

ProgramJob::ProgramJob(ReadProgram read, ProgramSurvey& survey, std::optional<double> rate)
    : name(std::move(read.notes.name)),
      read_as(std::move(read.notes.read_as)),
      warnings(std::move(read.notes.warnings)),
      totals(survey.totals()),
      machine_s(survey.machine().total_s()),
      open(std::move(read.open)),
      rate_hz(rate) {
  if (auto warning = warning_of_corners(name, survey.corner_cut_mm()))
    warnings.push_back(*std::move(warning));
  if (auto question = survey.machine().feed_question(name))
    warnings.push_back(*std::move(question));
}

ProgramJob::ProgramJob(Program program)
    : name(program.name), read_as(program.read_as), warnings(program.warnings) {
  MachineTime machine;
  for (const ProgramMotion& motion : program.motions) {
    totals.add(motion);
    machine.add(motion);
  }
  machine_s = machine.total_s();
  open = [list = std::make_shared<const Program>(std::move(program))] {
    return std::make_unique<ListReader>(list);
  };
}

}  // namespace kerf
