// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/formats/gcode/o_word.h"
#include "server/formats/gcode/parameters.h"
#include "server/formats/gcode/source.h"

namespace kerf {

/// Most subroutine calls within each other (LinuxCNC's figure).
inline constexpr std::size_t kGcodeCallDepthMax = 9;
/// Most lines in a row without a block that moves (kGcodeLinesMax: in all).
inline constexpr std::size_t kGcodeIdleLinesMax = 1'000'000;

/// Which line comes next: walks through the program, its subroutines, loops and branches (O words,
/// M98, M99). Throws GcodeFault; place() tells where.
class GcodeFlow {
 public:
  /// What has to happen where a subroutine begins and ends.
  struct Listener {
    std::function<void()> entered;
    std::function<void()> left;
    std::function<void(std::optional<double>)> returned;  ///< the value after return or endsub
    std::function<bool()> position_readable;
  };

  GcodeFlow(GcodeSource& source, GcodeParameters& parameters, std::size_t lines_max,
            Listener listener);

  /// The next line that is not control flow, without comments and blanks; none at the end of the
  /// text or at the closing '%'.
  std::optional<GcodeLine> next();
  /// The block that next() gave has moved something.
  void moved() { idle_ = 0; }

  /// Of the line at hand; lines count from 1.
  std::size_t file() const { return at_.file; }
  std::size_t line() const { return line_; }
  std::string_view line_text() const;
  /// The closing '%' has been met, or M99 in the program itself.
  bool ended() const { return ended_; }

 private:
  struct Place {
    std::size_t file = 0;
    std::size_t line = 0;  ///< index of the line that is read next
    friend bool operator==(const Place&, const Place&) = default;
  };
  enum class LabelKind { kDo, kWhile, kRepeat, kIf };
  struct Label {
    LabelKind kind;
    Place place;  ///< of its line
    int repeats_left = -1;
  };
  struct Frame {
    std::string subroutine;
    Place back;
    bool shared = false;  ///< M98: arguments are the caller's
    int repeats_left = 0;
    std::map<std::string, Label> labels;
  };

  void follow(const OWord& word);
  void define(const OWord& word);
  void call(const OWord& word);
  void enter(Place at, Frame frame, const std::vector<double>& arguments);
  void leave(const OWord& word);
  void begin_repeat(const OWord& word);
  void meet_while(const OWord& word);
  void choose(const OWord& word);
  void leave_branch(const OWord& word);
  void break_loop(const OWord& word, bool again);
  void end_loop(const OWord& word);
  Label& label(const OWord& word);
  Label& new_label(const OWord& word, LabelKind kind);
  /// Goes behind the next line whose O word has the name and one of the keywords; returns it.
  OWord skip_to(const std::string& name, std::initializer_list<OWord::Keyword> keywords,
                const std::string& reason);
  std::optional<Place> find_subroutine(const std::string& name, bool fanuc);
  OWord read(const GcodeLine& line, bool with_values) const;
  void count();
  static bool is_percent(std::string_view line);

  GcodeSource& source_;
  GcodeParameters& parameters_;
  std::size_t lines_max_;
  Listener listener_;
  Place at_;
  std::size_t line_ = 0;
  std::vector<Frame> frames_ = std::vector<Frame>(1);
  std::map<std::string, Place> subroutines_;  ///< lines of their "sub"
  std::size_t passed_ = 0, idle_ = 0;
  bool started_ = false, ended_ = false;
};

}  // namespace kerf
