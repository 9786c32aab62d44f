// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/sinumerik/values.h"

namespace kerf {

/// A line of a SINUMERIK program in capital letters, without number and label.
struct SinumerikLine {
  std::string text;     ///< without comment; blanks are kept
  std::string comment;  ///< after ';', as written
};

/// The lines of a program, with the positions of its structures and labels. `text` must outlive it.
/// Throws ProgramFault, with the line in at(), for structures that do not match.
class SinumerikProgram {
 public:
  explicit SinumerikProgram(std::string_view text);

  std::size_t size() const { return starts_.size(); }
  SinumerikLine line(std::size_t n) const;
  /// The line as written.
  std::string_view written(std::size_t n) const;
  /// The other end of a structure: IF and ELSE lead to the next ELSE or ENDIF, ends of loops to
  /// their heads and heads to their ends. Throws ProgramFault without one.
  std::size_t partner(std::size_t n) const;
  /// The line with a label or number, searched forward, backward or in this order.
  std::optional<std::size_t> label(const std::string& name, std::size_t from, char direction) const;

 private:
  void match();

  std::string_view text_;
  std::vector<std::size_t> starts_;
  std::map<std::size_t, std::size_t> partners_;
  std::map<std::string, std::vector<std::size_t>> labels_;
};

/// Determines the order of execution of lines: IF, WHILE, FOR, LOOP, REPEAT, GOTO.
class SinumerikFlow {
 public:
  SinumerikFlow(const SinumerikProgram& program, SinumerikValues& values, std::size_t executed_max)
      : program_(program), values_(values), left_(executed_max) {}

  /// The next line that is not control flow, or nullopt at the end. Throws ProgramFault.
  std::optional<SinumerikLine> next();
  /// The number of the line that next() returned or failed at, from 1.
  std::size_t line() const { return at_; }

 private:
  bool control(const std::string& text);
  bool jump(std::string_view text);
  void begin_for(std::string_view text);
  void end_for();
  double limit_of(std::string_view head, std::string& name, std::string_view& start) const;

  const SinumerikProgram& program_;
  SinumerikValues& values_;
  std::size_t left_, at_ = 0;
};

}  // namespace kerf
