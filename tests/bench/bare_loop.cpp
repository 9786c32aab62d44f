// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/bare_loop.h"

#include <algorithm>
#include <cmath>

#include "kernel/math/lanes.h"

namespace kerf::test {
namespace {

struct Row {
  float pitch, py, ax, az, dx, dy, per_length2;
};
struct Sums {
  float volume, x, z;
};

KERF_VECTOR_CLONES
void cut_row(float* tops, int i0, int i1, const Row& r, Sums& sums) {
  float volume = 0, x = 0, z = 0;
  for (int i = i0; i <= i1; ++i) {
    const float px = (float(i) + 0.5F) * r.pitch - r.ax;
    float s = (px * r.dx + r.py * r.dy) * r.per_length2;
    s = s > 0 ? s : 0;
    s = s < 1 ? s : 1;
    const float ex = px - s * r.dx, ey = r.py - s * r.dy;
    const float w2 = 25 - ex * ex - ey * ey;
    const float lowest = r.az - std::sqrt(w2 > 0 ? w2 : 0.0F);
    const float left = ((w2 > 0) & (lowest < tops[i])) ? lowest : tops[i];
    const float removed = tops[i] - left;
    volume += removed;
    x += removed * px;
    z += removed * (tops[i] + left);
    tops[i] = left;
  }
  sums = {volume, x, z};
}

}  // namespace

BareLoop::BareLoop(double pitch_mm)
    : columns_(int(100 / pitch_mm)),
      pitch_(float(pitch_mm)),
      top_(std::size_t(columns_) * std::size_t(columns_), 50.0F) {}

void BareLoop::move(Vec3 a, Vec3 b) {
  const auto index = [&](double x) { return std::clamp(int(x / double(pitch_)), 0, columns_ - 1); };
  Row row{pitch_, 0, float(a.x), float(a.z) + 5, float(b.x - a.x), float(b.y - a.y), 0};
  row.per_length2 = 1 / (row.dx * row.dx + row.dy * row.dy);
  const int i0 = index(std::min(a.x, b.x) - 5), i1 = index(std::max(a.x, b.x) + 5);
  for (int j = index(std::min(a.y, b.y) - 5); j <= index(std::max(a.y, b.y) + 5); ++j) {
    row.py = (float(j) + 0.5F) * pitch_ - float(a.y);
    Sums sums{};
    cut_row(&top_[std::size_t(j) * std::size_t(columns_)], i0, i1, row, sums);
    volume_ += double(sums.volume);
    moment_x_ += double(sums.x);
    moment_y_ += double(sums.volume * row.py);
    moment_z_ += double(sums.z);
  }
}

double BareLoop::removed_mm3() const { return volume_ * double(pitch_) * double(pitch_); }

}  // namespace kerf::test
