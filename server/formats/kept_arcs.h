// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/formats/program_writer.h"
#include "server/formats/scene.h"

namespace kerf {

/// Passes motions on to another writer, with the chords of an arc as one arc. The chords must
/// belong to one line of the program, and a reader must make the same chords from the written arc:
/// to the bit of the pose grid, or within `within_mm` if that is above 0, for controls with fewer
/// decimals. Radii at both ends may differ, because programs round their ends. Other motions pass
/// unchanged.
class KeptArcs final : public ProgramWriter {
 public:
  /// `scene`, whose tolerance divides arcs, must outlive it.
  KeptArcs(std::unique_ptr<ProgramWriter> writer, const Scene& scene, double within_mm)
      : writer_(std::move(writer)), scene_(scene), within_mm_(within_mm) {}

  void note(const std::string& line) override { writer_->note(line); }
  void set_number(const std::string& digits) override { writer_->set_number(digits); }
  WriteResult add(const ProgramMotion& motion) override;
  bool drills(const DrilledHole& hole) const override { return writer_->drills(hole); }
  WriteResult add_hole(const ProgramMotion& first, const DrilledHole& hole) override;
  WriteResult remark(const MachineRemark& said) override;
  WriteResult finish() override;

 private:
  using Motions = std::span<const ProgramMotion>;
  WriteResult flush();
  WriteResult write(Motions motions);
  std::optional<FittedArc> arc_of(Motions motions) const;
  bool makes(const FittedArc& arc, Motions motions) const;

  std::unique_ptr<ProgramWriter> writer_;
  const Scene& scene_;
  double within_mm_;
  std::vector<ProgramMotion> parts_;  ///< of one line, not yet written
};

}  // namespace kerf
