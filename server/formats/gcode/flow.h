// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/formats/gcode/o_word.h"
#include "server/formats/gcode/program_flow.h"

namespace kerf {

/// Deepest nesting of subroutine calls (LinuxCNC's value).
inline constexpr std::size_t kGcodeCallDepthMax = 9;
/// Control flow of LinuxCNC: subroutines, loops and branches (O words, M98, M99).
class GcodeFlow final : public ProgramFlow {
 public:
  /// Called where a subroutine begins and ends, and for the state of the machine.
  struct Listener {
    std::function<void()> entered;
    std::function<void()> left;
    std::function<void(std::optional<double>)> returned;  ///< value of return or endsub
    std::function<bool()> position_readable;              ///< as for GcodeValueReader
  };

  GcodeFlow(GcodeSource& source, GcodeParameters& parameters, std::size_t lines_max,
            Listener listener);

  std::optional<GcodeLine> next() override;

 private:
  enum class LabelKind { kDo, kWhile, kRepeat, kIf };
  struct Label {
    LabelKind kind;
    Place place;  ///< index of its own line
    int repeats_left = -1;
  };
  struct Frame {
    std::string subroutine;
    Place back;           ///< return address
    bool shared = false;  ///< M98: #1 to #30 are the caller's
    int repeats_left = 0;
    std::map<std::string, Label> labels;
  };

  void execute(const OWord& word);
  void define(const OWord& word);
  void call(const OWord& word);
  void enter(Place at, Frame frame, const std::vector<double>& arguments);
  void leave(const OWord& word);
  void begin_repeat(const OWord& word);
  void execute_while(const OWord& word);
  void begin_if(const OWord& word);
  void end_branch(const OWord& word);
  void break_loop(const OWord& word, bool again);
  void end_loop(const OWord& word);
  Label& label(const OWord& word);
  Label& new_label(const OWord& word, LabelKind kind);
  /// Continues after the next line whose O word has the name and one of the keywords. Returns that
  /// word. Throws ProgramFault with `reason` if there is no such line.
  OWord skip_to(const std::string& name, std::initializer_list<OWord::Keyword> keywords,
                const std::string& reason);
  std::optional<Place> find_subroutine(const std::string& name, bool fanuc);
  OWord read(const GcodeLine& line, bool with_values) const;

  Listener listener_;
  std::vector<Frame> frames_ = std::vector<Frame>(1);
  std::map<std::string, Place> subroutines_;  ///< line of each "sub"
};

}  // namespace kerf
