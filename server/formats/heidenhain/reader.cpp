// SPDX-License-Identifier: Apache-2.0
#include "server/formats/heidenhain/reader.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/control/line_reader.h"
#include "server/formats/heidenhain/flow.h"
#include "server/formats/heidenhain/machine.h"

namespace kerf {
namespace {

constexpr std::string_view kLanguage = "HEIDENHAIN";

class KlartextReader final : public LineReader {
 public:
  KlartextReader(const std::string& name, std::shared_ptr<const KlartextBlocks> blocks,
                 const Scene& scene, std::size_t executed_max, const std::string& wear)
      : blocks_(std::move(blocks)),
        flow_(*blocks_, values_, executed_max),
        machine_(
            scene, sink_, values_,
            [this](const std::string& text) { warn_once(text, flow_.line()); }, !wear.empty()) {
    program_.name = name;
    program_.read_as = "HEIDENHAIN Klartext";
    program_.files = {name};
    program_.lines = blocks_->lines();
    if (!wear.empty()) program_.warnings.push_back(wear);
  }

 private:
  bool execute() override {
    const KlartextBlock* block = flow_.next();
    if (block != nullptr && (flow_.execute() || !machine_.execute(*block, flow_.following())))
      return true;
    machine_.finish();
    return false;
  }

  ProgramError error_of(const ProgramFault& fault) const override {
    return {program_.name, flow_.line(), fault.word.empty() ? flow_.text() : fault.word,
            fault.reason, std::string(kLanguage)};
  }

  std::shared_ptr<const KlartextBlocks> blocks_;
  KlartextValues values_;
  KlartextFlow flow_;
  KlartextMachine machine_;
};

}  // namespace

std::expected<ReadProgram, ProgramError> read_klartext(const std::string& name,
                                                       std::string_view text, const Scene& scene,
                                                       std::size_t lines_max,
                                                       ProgramVisitor& visitor) {
  try {
    const auto blocks = std::make_shared<const KlartextBlocks>(text);
    const std::size_t executed_max = std::min(lines_max, text.size() + kRepeatedLinesMax);
    const auto read = [&](const std::string& wear) {
      return read_to_end(
          [name, blocks, &scene, executed_max, wear] {
            return std::make_unique<KlartextReader>(name, blocks, scene, executed_max, wear);
          },
          visitor);
    };
    return read_or_assume_wear(read, name, "RL and RR displace by 0");
  } catch (const ProgramFault& fault) {
    return std::unexpected(ProgramError{name, 0, fault.word, fault.reason, std::string(kLanguage)});
  }
}

}  // namespace kerf
