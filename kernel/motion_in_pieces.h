// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

namespace kerf {

/// A motion that a Sculpture is applying piece by piece (Sculpture::begin). Movable.
class MotionInPieces {
 public:
  struct State;
  explicit MotionInPieces(std::unique_ptr<State> state);
  MotionInPieces(MotionInPieces&&) noexcept;
  MotionInPieces& operator=(MotionInPieces&&) noexcept;
  ~MotionInPieces();

  State& state() { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

}  // namespace kerf
