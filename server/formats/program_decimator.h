// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "server/formats/program_writer.h"

namespace kerf {

/// Joins motions that follow one another into one, as long as no point of the tool, from its tip to
/// `reach_mm` along its axis, strays more than `tolerance_mm` from where it was: what the tool
/// sweeps changes by no more than that. The way is compared by length, so the tool may be elsewhere
/// at a time; the time for the whole stays the same. Rests, rapids and cuts are never joined with
/// each other. Passes everything on to `writer`.
class ProgramDecimator final : public ProgramWriter {
 public:
  ProgramDecimator(std::unique_ptr<ProgramWriter> writer, const Scene& scene, double tolerance_mm);

  void note(const std::string& line) override;
  WriteResult add(const ProgramMotion& motion) override;
  WriteResult finish() override;

 private:
  bool fits(const ToolPose& end) const;
  WriteResult flush();

  std::unique_ptr<ProgramWriter> writer_;
  const Scene& scene_;
  double tolerance_mm_;
  std::optional<ProgramMotion> joined_;  ///< not yet passed on
  std::vector<ToolPose> way_;            ///< through which it really goes, its ends included
};

}  // namespace kerf
