// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "server/formats/program_writer.h"

namespace kerf {

/// Writes the motions of holes as drilling cycles (DrilledHole), if the writer supports them.
/// Motions are a hole only if the cycle, as executed by the readers of G-code, makes exactly the
/// same poses. All other motions, and remarks, go to `writer` unchanged.
class DrillingCycles final : public ProgramWriter {
 public:
  explicit DrillingCycles(std::unique_ptr<ProgramWriter> writer);

  void note(const std::string& line) override;
  void set_number(const std::string& digits) override { writer_->set_number(digits); }
  WriteResult add(const ProgramMotion& motion) override;
  WriteResult remark(const MachineRemark& said) override;
  WriteResult finish() override;

 private:
  WriteResult flush();

  std::unique_ptr<ProgramWriter> writer_;
  std::vector<ProgramMotion> parts_;  ///< possibly of a hole, not yet forwarded
};

}  // namespace kerf
