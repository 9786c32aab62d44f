// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "server/formats/program_writer.h"

namespace kerf {

/// Joins consecutive motions into a straight one, or into an arc if the writer supports it, while
/// no point of the tool, from its tip to its end along the axis, deviates by more than
/// `tolerance_mm`. The swept volume changes by no more than that. Paths are compared by length, so
/// the position at a given time may differ. The total duration is kept. Motions of different kinds
/// (rests, rapids, cuts) or tools are never joined. Forwards the result to `writer`.
class ProgramDecimator final : public ProgramWriter {
 public:
  ProgramDecimator(std::unique_ptr<ProgramWriter> writer, const Scene& scene, double tolerance_mm);

  void note(const std::string& line) override;
  void set_number(const std::string& digits) override { writer_->set_number(digits); }
  WriteResult add(const ProgramMotion& motion) override;
  bool drills(const DrilledHole& hole) const override;
  WriteResult add_hole(const ProgramMotion& first, const DrilledHole& hole) override;
  WriteResult remark(const MachineRemark& said) override;
  WriteResult finish() override;

 private:
  bool fits(const ToolPose& end) const;
  void start(const ProgramMotion& motion);
  WriteResult write_first();
  WriteResult flush();

  std::unique_ptr<ProgramWriter> writer_;
  const Scene& scene_;
  double tolerance_mm_;
  std::vector<ProgramMotion> parts_;  ///< of the next motion, not yet forwarded
  std::vector<ToolPose> path_;        ///< their poses, both ends included
  bool line_ = true;                  ///< the parts can be joined to a line
  bool perhaps_arc_ = false;          ///< to an arc, or they are too few to decide
  std::optional<FittedArc> arc_;
};

}  // namespace kerf
