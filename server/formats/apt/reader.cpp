// SPDX-License-Identifier: Apache-2.0
#include "server/formats/apt/reader.h"

#include <memory>
#include <utility>

#include "server/formats/apt/machine.h"
#include "server/formats/control/line_reader.h"

namespace kerf {
namespace {

constexpr const char* kLanguage = "APT";

class AptReader final : public LineReader {
 public:
  AptReader(const std::string& name, std::string_view text, const Scene& scene,
            std::shared_ptr<const AptTools> tools)
      : tools_(std::move(tools)),
        statements_(text),
        machine_(scene, *tools_, sink_, [this](const std::string& said) { warn_here(said); }) {
    program_.name = name;
    program_.read_as = kLanguage;
    program_.files = {name};
  }

 private:
  bool execute() override {
    const auto statement = statements_.next();
    ended_ = statement && machine_.execute(*statement, statements_.line());
    return statement && !ended_;
  }

  void finish() override {
    if (!machine_.knows_any())
      throw ProgramFault{"", "has no statement of APT, such as GOTO/1,2,3"};
    if (!ended_ && !machine_.has_paths()) warn_here("the program ends without FINI");
    program_.lines = statements_.line();
  }

  ProgramError error_of(const ProgramFault& fault) const override {
    return {program_.name, statements_.line(), fault.word, fault.reason, kLanguage};
  }

  void warn_here(const std::string& text) {
    warn(program_.name + ":" + std::to_string(statements_.line()) + ": " + text);
  }

  std::shared_ptr<const AptTools> tools_;
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
