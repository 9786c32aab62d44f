// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

namespace kerf {

/// A vector whose memory the thread reuses from one tile to the next. Meshing a tile needs some
/// hundred kilobytes for a fraction of a millisecond, and returning them to the system each time
/// costs a third of that. Always starts empty. `kUse` distinguishes vectors of one type that exist
/// at the same time.
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
