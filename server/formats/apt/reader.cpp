// SPDX-License-Identifier: Apache-2.0
#include "server/formats/apt/reader.h"

#include <memory>
#include <utility>

#include "server/formats/apt/machine.h"

namespace kerf {
namespace {

constexpr const char* kLanguage = "APT";
/// Pieces of a path per step.
constexpr int kPiecesPerStep = 64;

class AptReader final : public ProgramReader {
 public:
  AptReader(const std::string& name, std::string_view text, const Scene& scene,
            std::shared_ptr<const AptTools> tools)
      : tools_(std::move(tools)),
        sink_(program_),
        statements_(text),
        machine_(scene, *tools_, sink_, [this](const std::string& said) { warn(said); }) {
    program_.name = name;
    program_.read_as = kLanguage;
    program_.files = {name};
  }

  std::expected<bool, ProgramError> step() override {
    if (sink_.waits()) {
      const auto followed = sink_.go_on(kPiecesPerStep);
      if (!followed) return std::unexpected(error("", followed.error()));
      return true;
    }
    try {
      if (const auto statement = ended_ ? std::nullopt : statements_.next()) {
        if (!machine_.execute(*statement, statements_.line())) return true;
        ended_ = true;
      }
    } catch (const ProgramFault& fault) {
      return std::unexpected(fault_behind_waiting(fault));
    }
    if (sink_.waits()) return true;
    if (!machine_.knows_any())
      return std::unexpected(error("", "has no statement of APT, such as GOTO/1,2,3"));
    if (!ended_ && !machine_.has_paths()) warn("the program ends without FINI");
    program_.lines = statements_.line();
    return false;
  }

 private:
  ProgramError error(std::string word, std::string reason) const {
    return {program_.name, statements_.line(), std::move(word), std::move(reason), kLanguage};
  }

  // Pending motions precede the fault, and may be invalid too.
  ProgramError fault_behind_waiting(const ProgramFault& fault) {
    while (sink_.waits()) {
      if (const auto followed = sink_.go_on(kPiecesPerStep); !followed)
        return error("", followed.error());
      program_.motions.clear();
    }
    return error(fault.word, fault.reason);
  }

  void warn(const std::string& text) {
    if (program_.warnings.size() < kProgramWarningsMax)
      program_.warnings.push_back(program_.name + ":" + std::to_string(statements_.line()) + ": " +
                                  text);
  }

  std::shared_ptr<const AptTools> tools_;
  MotionSink sink_;
  AptStatements statements_;
  AptMachine machine_;
  bool ended_ = false;
};

}  // namespace

std::expected<ReadProgram, ProgramError> read_apt(const std::string& name, std::string_view text,
                                                  const Scene& scene, ProgramVisitor& visitor) {
  const auto tools = std::make_shared<const AptTools>(apt_tools(text));
  return read_to_end(
      [name, text, &scene, tools] { return std::make_unique<AptReader>(name, text, scene, tools); },
      visitor);
}

}  // namespace kerf
