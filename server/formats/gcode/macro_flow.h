// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/formats/gcode/parameters.h"
#include "server/formats/gcode/program_flow.h"
#include "server/formats/gcode/source.h"

namespace kerf {

/// Deepest nesting of calls in Macro B, above that of any control.
inline constexpr std::size_t kMacroCallDepthMax = 15;

/// Control flow of Macro B (Fanuc, Haas, Mach3): subprograms (M97, M98, M99), macro calls (G65,
/// G66), jumps, branches and loops (GOTO, IF, WHILE, DO, END).
class MacroFlow final : public ProgramFlow {
 public:
  struct Listener {
    std::function<void()> entered, left;
    std::function<bool()> position_readable;  ///< as for GcodeValueReader
    std::function<void(const std::string&)> warn;
  };
  /// A call or jump, from a block with M97, M98, M99, or of G65 and G66.
  struct Call {
    enum class Kind { kSubprogram, kLocal, kLocalElseSubprogram, kReturn, kMacro, kModal };
    Kind kind = Kind::kSubprogram;
    int number = 0;  ///< O number; of kLocal… N; of kReturn N to return to, or 0
    int repeats = 1;
    std::vector<double> arguments;  ///< #1 to #33
    std::string text;               ///< for errors
  };

  MacroFlow(GcodeSource& source, GcodeParameters& parameters, const DialectRules& rules,
            std::size_t lines_max, Listener listener);

  std::optional<GcodeLine> next() override;
  void moved() override;

  /// Removes M97, M98 or M99 with its P and L from a block and returns the call, or nullopt.
  static std::optional<Call> take_call(GcodeBlock& block);
  /// Reads "g65p…" or "g66p…", or nullopt for any other code.
  std::optional<Call> read_macro_call(std::string_view code) const;
  /// G67 ends the calls of G66.
  void end_modal() { modal_.reset(); }
  /// Executes a call. Returns true if it ends the program: M99 of the main program.
  bool execute(const Call& call);

 private:
  struct Frame {
    Place start, back;
    bool shares = true;  ///< M97, M98: the local variables are the caller's
    int repeats_left = 0;
    std::vector<double> arguments = {};
  };

  /// Executes IF, WHILE, DO, END and GOTO. Returns the rest of the line to execute, or nullopt.
  std::optional<std::string> control(const std::string& code);
  std::optional<std::string> branch(const std::string& code);
  void loop(const std::string& code);
  void jump(int sequence, const std::string& text);
  void enter(Place start, const Call& call);
  bool leave(const Call& call);
  /// The first line after the header of a program.
  std::optional<Place> find_program(int number);

  const DialectRules& rules_;
  Listener listener_;
  std::vector<Frame> frames_;
  std::optional<Call> modal_;  ///< G66
  std::size_t modal_depth_ = 0;
  bool header_seen_ = false, skips_said_ = false;
};

}  // namespace kerf
