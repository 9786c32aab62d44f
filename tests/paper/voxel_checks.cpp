// SPDX-License-Identifier: Apache-2.0
// The paper's first claim: dexels need fewer elements and less memory than voxels.

#include "tests/paper/voxel_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <limits>
#include <random>

#include "kernel/sculpture.h"
#include "tests/paper/check.h"
#include "tests/paper/examples.h"
#include "tests/paper/voxel_block.h"

namespace kerf::paper {
namespace {

constexpr BoxStock kStock{{0, 0, 0}, {24, 24, 20}};
constexpr double kPitchMm = 0.25;
/// End-point errors to be met, along the ray: half the edge of a cube.
constexpr std::array kErrorsMm{0.1, 0.05, 0.025};

struct Move {
  Mill mill;
  Vec3 from, to;
};

/// 300 ramps of 1 to 6 mm, of a ball and a flat mill of 6 mm in turn, anywhere in the block.
const std::vector<Move>& job() {
  static const std::vector<Move> kJob = [] {
    std::mt19937_64 random(7);
    const auto in = [&](double a, double b) {
      return a + (b - a) * double(random() >> 11) * 0x1p-53;
    };
    std::vector<Move> moves;
    for (int n = 0; n < 300; ++n) {
      const Vec3 from{in(0, 24), in(0, 24), in(8, 19)};
      moves.push_back({{n % 2 == 0, 3}, from, from + Vec3{in(-4, 4), in(-4, 4), in(-2, 2)}});
    }
    return moves;
  }();
  return kJob;
}

Sculpture dexels(double pitch_mm) {
  Sculpture block =
      Sculpture::create({.stock = kStock, .pitch_mm = pitch_mm, .keep_normals = false}).value();
  block.apply(DefineTool{1, make_tool(BallShape{6, 40}).value()}).value();
  block.apply(DefineTool{2, make_tool(FlatShape{6, 40}).value()}).value();
  return block;
}

void cut(Sculpture& block) {
  for (const Move& move : job()) {
    block.apply(MoveTool{move.mill.ball ? 1U : 2U, {move.from}, {move.to}, 0, false}).value();
  }
}

void cut(VoxelBlock& block) {
  for (const Move& move : job()) block.cut(move.mill, move.from, move.to);
}

/// Elements and memory that a model of the cut block needs, and how far its columns end from the
/// true surface.
struct Model {
  std::size_t elements = 0, bytes = 0;
  double error_mm = 0;
};

double true_top_mm(double x, double y) {
  double top = kStock.max_mm.z;
  for (const Move& move : job()) {
    if (std::abs(x - move.from.x) > 8 || std::abs(y - move.from.y) > 8) continue;
    top = std::min(top, move.mill.lowest_mm(move.from, move.to, x, y));
  }
  return top;
}

Model model_of(double pitch_mm) {
  Sculpture block = dexels(pitch_mm);
  cut(block);
  Model model{0, block.memory_bytes(), 0};
  const DexelSnapshot field = block.snapshot();
  const DexelGrid& grid = field.grid();
  std::vector<Dexel> scratch;
  for (std::int32_t j = 0; j < grid.columns_y; ++j) {
    for (std::int32_t i = 0; i < grid.columns_x; ++i) {
      const auto column = field.column(i, j, scratch);
      model.elements += column.size();
      if ((i + j) % 5 != 0 || column.empty()) continue;
      const double off = grid.z_mm(column.back().top) - true_top_mm(grid.x_mm(i), grid.y_mm(j));
      model.error_mm = std::max(model.error_mm, std::abs(off));
    }
  }
  return model;
}

Model voxels_of(double edge_mm) {
  VoxelBlock block(kStock, edge_mm);
  cut(block);
  Model model{block.voxels(), block.bytes(), 0};
  for (int j = 0; j < block.columns_y(); ++j) {
    for (int i = j % 5; i < block.columns_x(); i += 5) {
      const double off = block.top_mm(i, j) - true_top_mm(block.x_mm(i), block.y_mm(j));
      model.error_mm = std::max(model.error_mm, std::abs(off));
    }
  }
  return model;
}

struct Pair {
  double error_mm;
  Model voxels, dexels;  ///< with the same lateral pitch
};

const std::vector<Pair>& pairs() {
  static const std::vector<Pair> kPairs = [] {
    std::vector<Pair> all;
    for (const double e : kErrorsMm) all.push_back({e, voxels_of(2 * e), model_of(2 * e)});
    return all;
  }();
  return kPairs;
}

const Model& coarse() {
  static const Model kModel = model_of(kPitchMm);
  return kModel;
}

Finding voxels_need_more() {
  bool holds = coarse().error_mm < 1e-5;
  double fewer = std::numeric_limits<double>::infinity(), smaller = fewer;
  for (const Pair& pair : pairs()) {
    holds = holds && pair.voxels.error_mm <= pair.error_mm && pair.dexels.error_mm < 1e-5 &&
            pair.voxels.error_mm > 0.9 * pair.error_mm;
    fewer = std::min(fewer, double(pair.voxels.elements) / double(pair.dexels.elements));
    smaller = std::min(smaller, double(pair.voxels.bytes) / double(pair.dexels.bytes));
  }
  const Pair& fine = pairs().back();
  const double most = double(fine.voxels.elements) / double(coarse().elements);
  const double bytes = double(fine.voxels.bytes) / double(coarse().bytes);
  return {
      holds && fewer > 30 && smaller > 1 && most > 1000 && bytes > 30,
      text("columns as fine as the voxels: at least %.0f times fewer elements, %.1f times fewer "
           "bytes; columns %.2f mm apart against voxels for %.3f mm: %.0f and %.0f times",
           fewer, smaller, kPitchMm, kErrorsMm.back(), most, bytes)};
}

template <class Block>
double seconds_of(Block block) {
  const std::clock_t begin = std::clock();
  cut(block);
  return double(std::clock() - begin) / CLOCKS_PER_SEC;
}

}  // namespace

std::string voxel_table() {
  std::string table =
      "| end-point error | voxels: edge, error | elements | bytes | dexels: pitch, error | "
      "elements | "
      "bytes | voxels over dexels |\n|---|---|---|---|---|---|---|---|\n";
  const auto add = [&](double e, const Model& v, double pitch, const Model& d) {
    table += text(
        "| %g mm | %g, %.3f mm | %zu | %zu | %g, < 1e-5 mm | %zu | %zu | %.0f elements, "
        "%.1f bytes |\n",
        e, 2 * e, v.error_mm, v.elements, v.bytes, pitch, d.elements, d.bytes,
        double(v.elements) / double(d.elements), double(v.bytes) / double(d.bytes));
  };
  for (const Pair& pair : pairs()) add(pair.error_mm, pair.voxels, 2 * pair.error_mm, pair.dexels);
  for (const Pair& pair : pairs()) add(pair.error_mm, pair.voxels, kPitchMm, coarse());
  return table;
}

std::string voxel_times(int rounds) {
  std::string table =
      "| end-point error | voxels | dexels as fine | ratio | dexels of 0.25 mm | ratio |\n"
      "|---|---|---|---|---|---|\n";
  for (const double e : kErrorsMm) {
    double voxels = HUGE_VAL, fine = HUGE_VAL, few = HUGE_VAL;
    for (int n = 0; n < rounds; ++n) {
      voxels = std::min(voxels, seconds_of(VoxelBlock(kStock, 2 * e)));
      fine = std::min(fine, seconds_of(dexels(2 * e)));
      few = std::min(few, seconds_of(dexels(kPitchMm)));
    }
    table += text("| %g mm | %.1f ms | %.1f ms | %.2f | %.1f ms | %.1f |\n", e, 1e3 * voxels,
                  1e3 * fine, voxels / fine, 1e3 * few, voxels / few);
  }
  return table;
}

std::vector<Check> voxel_checks() { return {{"VoxelsNeedMoreThanDexels", voxels_need_more}}; }

}  // namespace kerf::paper
