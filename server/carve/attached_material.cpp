// SPDX-License-Identifier: Apache-2.0
#include "server/carve/attached_material.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

namespace kerf {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

bool overlap(const Dexel& a, const Dexel& b) { return a.bottom < b.top && b.bottom < a.top; }

}  // namespace

/// The elements of a row of columns.
struct AttachedMaterial::Row {
  std::vector<std::size_t> first;  ///< first element of each column, and the end
  std::vector<Dexel> elements;
  std::vector<std::uint32_t> labels;
};

AttachedMaterial::AttachedMaterial(const DexelSnapshot& block, const DexelSnapshot& part)
    : columns_x_(block.grid().columns_x) {
  const DexelGrid& grid = block.grid();
  first_.reserve(std::size_t(grid.columns_x) * std::size_t(grid.columns_y));
  std::vector<double> quanta;  // of each label, summed over the columns
  Row before, row;
  before.first.assign(std::size_t(columns_x_) + 1, 0);
  for (std::int32_t j = 0; j < grid.columns_y; ++j) {
    add_row(block, part, j, before, row);
    quanta.resize(parents_.size());
    for (std::int32_t i = 0; i < columns_x_; ++i) {
      for (std::size_t n = row.first[std::size_t(i)]; n < row.first[std::size_t(i) + 1]; ++n) {
        const Dexel& d = row.elements[n];
        quanta[row.labels[n]] += (d.top - d.bottom) * block.shares().of(i, j);
      }
    }
    std::swap(before, row);
  }
  for (std::uint32_t label = 0; label < parents_.size(); ++label)
    if (attached_[label]) attached_[piece_of(label)] = true;
  for (std::uint32_t label = 0; label < parents_.size(); ++label) {
    attached_[label] = attached_[piece_of(label)];
    if (!attached_[label]) loose_mm3_ += quanta[label] * grid.quantum_mm3();
  }
  parents_ = {};
}

void AttachedMaterial::add_row(const DexelSnapshot& block, const DexelSnapshot& part,
                               std::int32_t j, const Row& before, Row& row) {
  row = {};
  std::vector<Dexel> scratch, part_scratch;
  for (std::int32_t i = 0; i < columns_x_; ++i) {
    const auto at = std::size_t(i);
    row.first.push_back(row.elements.size());
    first_.push_back(labels_.size());
    const auto of_part = part.column(i, j, part_scratch);
    for (const Dexel& element : block.column(i, j, scratch)) {
      std::uint32_t label = kNone;
      for (std::size_t n = i > 0 ? row.first[at - 1] : 0; n < row.first[at]; ++n)
        if (overlap(element, row.elements[n])) join(label, row.labels[n]);
      for (std::size_t n = before.first[at]; n < before.first[at + 1]; ++n)
        if (overlap(element, before.elements[n])) join(label, before.labels[n]);
      if (label == kNone) {
        label = static_cast<std::uint32_t>(parents_.size());
        parents_.push_back(label);
        attached_.push_back(false);
      }
      if (std::ranges::any_of(of_part, [&](const Dexel& d) { return overlap(element, d); }))
        attached_[label] = true;
      row.elements.push_back(element);
      row.labels.push_back(label);
      labels_.push_back(label);
    }
  }
  row.first.push_back(row.elements.size());
}

std::uint32_t AttachedMaterial::piece_of(std::uint32_t label) {
  while (parents_[label] != label) {
    parents_[label] = parents_[parents_[label]];
    label = parents_[label];
  }
  return label;
}

void AttachedMaterial::join(std::uint32_t& label, std::uint32_t other) {
  const std::uint32_t piece = piece_of(other);
  if (label == kNone) {
    label = piece;
    return;
  }
  const std::uint32_t own = piece_of(label);
  parents_[std::max(own, piece)] = std::min(own, piece);
  label = std::min(own, piece);
}

bool AttachedMaterial::is_attached(std::int32_t i, std::int32_t j, std::size_t n) const {
  const std::size_t column = std::size_t(j) * std::size_t(columns_x_) + std::size_t(i);
  return attached_[labels_[first_[column] + n]];
}

}  // namespace kerf
