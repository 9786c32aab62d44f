// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "server/formats/heidenhain/blocks.h"
#include "server/formats/heidenhain/values.h"

namespace kerf {

/// Determines the next block to execute: labels, CALL LBL, REP and the jumps of FN 9 to FN 12.
class KlartextFlow {
 public:
  /// `blocks` and `values` must outlive the flow.
  KlartextFlow(const KlartextBlocks& blocks, KlartextValues& values, std::size_t executed_max)
      : blocks_(blocks), values_(values), executed_max_(executed_max) {}

  /// Moves to the next block. Returns nullptr at the end. Throws ProgramFault above the limit of
  /// blocks.
  const KlartextBlock* next();
  /// Executes the current block if it is control flow or assigns a parameter.
  bool execute();
  /// The text of the block after the current one, or "" at the end.
  const std::string& following() const;
  std::size_t line() const { return block_.line; }
  const std::string& text() const { return block_.text; }

 private:
  void call(const std::string& rest);
  void jump(const std::string& label);
  bool function(const std::string& text);
  void jump_if(const std::string& text);

  const KlartextBlocks& blocks_;
  KlartextValues& values_;
  std::size_t executed_max_, executed_ = 0;
  std::size_t next_ = 0, current_ = 0;
  KlartextBlock block_;                    ///< the current one
  mutable std::size_t following_ = 0;      ///< the number of
  mutable KlartextBlock following_block_;  ///< number of the block read ahead; 0 without one
  std::vector<std::size_t> returns_;
  std::map<std::size_t, int> repeats_;  ///< done, by the block of CALL LBL … REP
};

}  // namespace kerf
