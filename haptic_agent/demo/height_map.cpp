// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/demo/height_map.h"

#include <algorithm>
#include <cmath>

namespace kerf::demo {

HeightMap::HeightMap(Vec3 min_mm, Vec3 max_mm, double pitch_mm,
                     const std::function<double(double, double)>& height)
    : min_mm_(min_mm),
      pitch_mm_(pitch_mm),
      columns_(std::lround((max_mm.x - min_mm.x) / pitch_mm) + 1),
      rows_(std::lround((max_mm.y - min_mm.y) / pitch_mm) + 1) {
  heights_.reserve(static_cast<std::size_t>(columns_ * rows_));
  for (std::ptrdiff_t row = 0; row < rows_; ++row) {
    for (std::ptrdiff_t column = 0; column < columns_; ++column) {
      heights_.push_back(height(min_mm.x + static_cast<double>(column) * pitch_mm,
                                min_mm.y + static_cast<double>(row) * pitch_mm));
    }
  }
}

double HeightMap::node(std::ptrdiff_t column, std::ptrdiff_t row) const {
  column = std::clamp<std::ptrdiff_t>(column, 0, columns_ - 1);
  row = std::clamp<std::ptrdiff_t>(row, 0, rows_ - 1);
  return heights_[static_cast<std::size_t>(row * columns_ + column)];
}

double HeightMap::at(double x_mm, double y_mm) const {
  const double u = (x_mm - min_mm_.x) / pitch_mm_, v = (y_mm - min_mm_.y) / pitch_mm_;
  const double column = std::floor(u), row = std::floor(v);
  const double a = u - column, b = v - row;
  const auto i = static_cast<std::ptrdiff_t>(column), j = static_cast<std::ptrdiff_t>(row);
  return (1 - b) * ((1 - a) * node(i, j) + a * node(i + 1, j)) +
         b * ((1 - a) * node(i, j + 1) + a * node(i + 1, j + 1));
}

Vec3 HeightMap::normal(double x_mm, double y_mm, double reach_mm) const {
  const double dx = at(x_mm + reach_mm, y_mm) - at(x_mm - reach_mm, y_mm);
  const double dy = at(x_mm, y_mm + reach_mm) - at(x_mm, y_mm - reach_mm);
  return normalized(Vec3{-dx, -dy, 2 * reach_mm});
}

HeightMap HeightMap::centers_of_ball(double radius_mm) const {
  struct Offset {
    std::ptrdiff_t column, row;
    double rise;
  };
  std::vector<Offset> offsets;
  const auto reach = static_cast<std::ptrdiff_t>(radius_mm / pitch_mm_);
  for (std::ptrdiff_t row = -reach; row <= reach; ++row) {
    for (std::ptrdiff_t column = -reach; column <= reach; ++column) {
      const double square =
          radius_mm * radius_mm -
          static_cast<double>(column * column + row * row) * pitch_mm_ * pitch_mm_;
      if (square >= 0) offsets.push_back({column, row, std::sqrt(square)});
    }
  }
  HeightMap centers = *this;
  for (std::ptrdiff_t row = 0; row < rows_; ++row) {
    for (std::ptrdiff_t column = 0; column < columns_; ++column) {
      double& highest = centers.heights_[static_cast<std::size_t>(row * columns_ + column)];
      for (const Offset& o : offsets) {
        highest = std::max(highest, node(column + o.column, row + o.row) + o.rise);
      }
    }
  }
  return centers;
}

}  // namespace kerf::demo
