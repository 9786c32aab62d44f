// SPDX-License-Identifier: Apache-2.0
#include "server/formats/heidenhain/reader.h"

#include <algorithm>
#include <set>
#include <utility>

#include "server/formats/gcode/fault.h"
#include "server/formats/heidenhain/flow.h"
#include "server/formats/heidenhain/machine.h"

namespace kerf {
namespace {

/// Most blocks that are executed beyond the size of a program, in repeats and calls.
constexpr std::size_t kRepeatedMax = 1'000'000;

}  // namespace

std::expected<Program, ProgramError> read_klartext(const std::string& name, std::string_view text,
                                                   const Scene& scene, std::size_t lines_max) {
  Program program;
  program.name = name;
  program.files = {name};
  const KlartextBlocks blocks = split_klartext(text);
  program.lines = blocks.lines;
  MotionSink sink(program);
  KlartextValues values;
  KlartextFlow flow(blocks, values, std::min(lines_max, text.size() + kRepeatedMax));
  std::set<std::string> warned;
  const auto warn = [&](const std::string& warning) {
    if (!warned.insert(warning).second || program.warnings.size() >= kProgramWarningsMax) return;
    program.warnings.push_back(name + ":" + std::to_string(flow.line()) + ": " + warning);
  };
  KlartextMachine machine(scene, sink, values, warn);
  const auto fail = [&](std::string word, std::string reason) {
    if (word.empty()) word = flow.text();
    return std::unexpected(
        ProgramError{name, flow.line(), std::move(word), std::move(reason), "HEIDENHAIN"});
  };
  try {
    while (const KlartextBlock* block = flow.next()) {
      if (flow.execute()) continue;
      if (machine.execute(*block, flow.following())) break;
    }
    machine.finish();
  } catch (const KlartextFault& fault) {
    return fail(fault.word, fault.reason);
  } catch (const GcodeFault& fault) {
    return fail(fault.word, fault.reason);
  }
  return program;
}

}  // namespace kerf
