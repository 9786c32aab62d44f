// SPDX-License-Identifier: Apache-2.0
#include "server/formats/heidenhain/reader.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/compensation.h"
#include "server/formats/heidenhain/flow.h"
#include "server/formats/heidenhain/machine.h"
#include "server/formats/motion_sink.h"

namespace kerf {
namespace {

/// Most blocks executed beyond the size of a program, in repeats and calls.
constexpr std::size_t kRepeatedMax = 1'000'000;
constexpr std::string_view kLanguage = "HEIDENHAIN";

/// Pieces of a path per step.
constexpr int kPiecesPerStep = 64;

class KlartextReader final : public ProgramReader {
 public:
  KlartextReader(const std::string& name, std::shared_ptr<const KlartextBlocks> blocks,
                 const Scene& scene, std::size_t executed_max, const std::string& wear)
      : blocks_(std::move(blocks)),
        sink_(program_),
        flow_(*blocks_, values_, executed_max),
        machine_(
            scene, sink_, values_, [this](const std::string& text) { warn(text); }, !wear.empty()) {
    program_.name = name;
    program_.read_as = "HEIDENHAIN Klartext";
    program_.files = {name};
    program_.lines = blocks_->lines();
    if (!wear.empty()) program_.warnings.push_back(wear);
  }

  std::expected<bool, ProgramError> step() override {
    if (sink_.waits()) {
      if (auto error = follow_path()) return std::unexpected(*std::move(error));
    } else if (auto error = execute()) {
      while (sink_.waits()) {  // pending motions precede the fault, and may be invalid too
        if (auto earlier = follow_path()) return std::unexpected(*std::move(earlier));
        program_.motions.clear();
      }
      return std::unexpected(*std::move(error));
    }
    return runs_ || sink_.waits();
  }

 private:
  std::optional<ProgramError> execute() {
    try {
      const KlartextBlock* block = flow_.next();
      runs_ = block != nullptr && (flow_.execute() || !machine_.execute(*block, flow_.following()));
      if (!runs_) machine_.finish();
    } catch (const ProgramFault& fault) {
      return error(fault.word, fault.reason);
    }
    return std::nullopt;
  }

  std::optional<ProgramError> follow_path() {
    const auto followed = sink_.go_on(kPiecesPerStep);
    return followed ? std::nullopt : std::optional(error({}, followed.error()));
  }

  ProgramError error(const std::string& word, std::string reason) const {
    return {program_.name, flow_.line(), word.empty() ? flow_.text() : word, std::move(reason),
            std::string(kLanguage)};
  }

  void warn(const std::string& text) {
    if (program_.warnings.size() >= kProgramWarningsMax || !warned_.insert(text).second) return;
    program_.warnings.push_back(program_.name + ":" + std::to_string(flow_.line()) + ": " + text);
  }

  std::shared_ptr<const KlartextBlocks> blocks_;
  MotionSink sink_;
  KlartextValues values_;
  KlartextFlow flow_;
  std::set<std::string> warned_;
  KlartextMachine machine_;
  bool runs_ = true;
};

}  // namespace

std::expected<ReadProgram, ProgramError> read_klartext(const std::string& name,
                                                       std::string_view text, const Scene& scene,
                                                       std::size_t lines_max,
                                                       ProgramVisitor& visitor) {
  try {
    const auto blocks = std::make_shared<const KlartextBlocks>(text);
    const std::size_t executed_max = std::min(lines_max, text.size() + kRepeatedMax);
    const auto read = [&](const std::string& wear) {
      return read_to_end(
          [name, blocks, &scene, executed_max, wear] {
            return std::make_unique<KlartextReader>(name, blocks, scene, executed_max, wear);
          },
          visitor);
    };
    auto first = read({});
    if (first || !is_compensation_fault(first.error().reason)) return first;
    auto again = read(name + ":" + std::to_string(first.error().line) +
                      ": RL and RR displace by 0, as for a path of the tool's center: the tool's "
                      "radius is not possible here");
    return again || again.error().line > first.error().line ? std::move(again) : std::move(first);
  } catch (const ProgramFault& fault) {
    return std::unexpected(ProgramError{name, 0, fault.word, fault.reason, std::string(kLanguage)});
  }
}

}  // namespace kerf
