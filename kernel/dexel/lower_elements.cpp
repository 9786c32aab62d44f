// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/lower_elements.h"

#include <algorithm>
#include <bit>

#include "kernel/dexel/tile_index.h"

namespace kerf {
namespace {

/// Returns the class c whose blocks, of 2^c elements, hold `count` elements.
std::size_t size_class_of(std::size_t count) { return std::size_t(std::bit_width(count - 1)); }

}  // namespace

template <class Element>
std::uint32_t LowerElements<Element>::take_block(std::size_t size_class) {
  if (free_[size_class] != kNone) {
    const std::uint32_t first = free_[size_class];
    free_[size_class] = std::bit_cast<std::uint32_t>(pool_[first].bottom);
    return first;
  }
  const std::size_t first = pool_.size();
  pool_.resize(first + (std::size_t{1} << size_class));
  return static_cast<std::uint32_t>(first);
}

template <class Element>
void LowerElements<Element>::give_block(std::uint32_t first, std::size_t size_class) {
  pool_[first].bottom = std::bit_cast<decltype(Element::bottom)>(free_[size_class]);
  free_[size_class] = first;
}

template <class Element>
typename LowerElements<Element>::Run& LowerElements<Element>::run_for(int column) {
  std::uint16_t& n = run_of_[std::size_t(column)];
  if (n == kNoRun) {
    if (free_runs_.empty()) {
      n = static_cast<std::uint16_t>(runs_.size());
      runs_.emplace_back();
    } else {
      n = free_runs_.back();
      free_runs_.pop_back();
    }
  }
  return runs_[n];
}

template <class Element>
void LowerElements<Element>::assign(int column, std::span<const Element> elements) {
  if (run_of_.empty()) {
    if (elements.empty()) return;
    run_of_.assign(kTileColumns, kNoRun);
  }
  if (elements.empty() && run_of_[std::size_t(column)] == kNoRun) return;
  Run& run = run_for(column);
  const bool held = run.count > 0;
  const std::size_t from = held ? size_class_of(run.count) : 0;
  const std::size_t to = elements.empty() ? 0 : size_class_of(elements.size());
  if (held && (elements.empty() || from != to)) give_block(run.first, from);
  if (!elements.empty() && (!held || from != to)) run.first = take_block(to);
  run.count = static_cast<std::uint32_t>(elements.size());
  std::ranges::copy(elements, pool_.begin() + std::ptrdiff_t(run.first));
  if (elements.empty()) {
    std::uint16_t& n = run_of_[std::size_t(column)];
    free_runs_.push_back(n);
    n = kNoRun;
  }
}

template <class Element>
std::size_t LowerElements<Element>::bytes() const {
  return run_of_.capacity() * sizeof(std::uint16_t) + runs_.capacity() * sizeof(Run) +
         free_runs_.capacity() * sizeof(std::uint16_t) + pool_.capacity() * sizeof(Element);
}

template class LowerElements<Dexel>;
template class LowerElements<EndCodes>;

}  // namespace kerf
