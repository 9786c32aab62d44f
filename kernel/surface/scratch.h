// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

namespace kerf {

/// A vector whose memory a thread keeps from one tile to the next: meshing a tile takes some
/// hundred kilobytes for a fraction of a millisecond, and giving them back to the system each time
/// costs a third of that. Begins empty; nothing of its contents is ever seen again. `kUse` tells
/// apart vectors of one type that live at the same time.
template <class T, int kUse = 0>
class Scratch {
 public:
  Scratch() : values_(std::move(kept())) { values_.clear(); }
  ~Scratch() { kept() = std::move(values_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  std::vector<T>& operator*() { return values_; }
  const std::vector<T>& operator*() const { return values_; }
  std::vector<T>* operator->() { return &values_; }
  const std::vector<T>* operator->() const { return &values_; }

 private:
  static std::vector<T>& kept() {
    thread_local std::vector<T> memory;
    return memory;
  }
  std::vector<T> values_;
};

}  // namespace kerf
