// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace kerf::sim {

/// What servers have answered to those who changed something, and what must therefore be so at the
/// end.
class Promises {
 public:
  enum class State : std::uint8_t {
    kAbsent,
    kPresent,
    kUnknown  ///< a change was sent, and nothing has been answered
  };

  /// A change of something was sent. What it was is not sure until the answer.
  void ask(const std::string& what) {
    states_[what] = State::kUnknown;
    std::erase_if(together_, [&](const std::vector<std::string>& all) {
      return std::ranges::find(all, what) != all.end();
    });
  }
  /// A change of all of these in one request was sent, each in the other state before: all of them
  /// happen or none.
  void ask(const std::vector<std::string>& all) {
    for (const std::string& what : all) ask(what);
    together_.push_back(all);
  }
  /// The answer says what it is now.
  void promise(const std::string& what, bool is_present) {
    states_[what] = is_present ? State::kPresent : State::kAbsent;
    ++kept_;
  }
  /// A sentence for each promise that is broken by what is there at the end.
  std::vector<std::string> broken(const std::map<std::string, bool>& present) const {
    std::vector<std::string> sentences;
    for (const auto& [what, state] : states_) {
      const auto found = present.find(what);
      const bool is_present = found != present.end() && found->second;
      if (state == State::kPresent && !is_present)
        sentences.push_back(what + " was promised and is gone");
      if (state == State::kAbsent && is_present)
        sentences.push_back(what + " was ended and is there");
    }
    const auto is_there = [&](const std::string& what) {
      const auto found = present.find(what);
      return found != present.end() && found->second;
    };
    for (const auto& all : together_) {
      const auto changed = std::ranges::count_if(all, is_there);
      if (changed != 0 && changed != std::ssize(all)) {
        sentences.push_back("of " + std::to_string(all.size()) + " changes of one request " +
                            std::to_string(changed) + " have happened: " + all.front());
      }
    }
    return sentences;
  }
  /// Answers that promised something.
  std::uint64_t count() const { return kept_; }

 private:
  std::map<std::string, State> states_;
  std::vector<std::vector<std::string>> together_;
  std::uint64_t kept_ = 0;
};

}  // namespace kerf::sim
