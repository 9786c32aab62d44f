// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/vertex_error.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "tests/kernel/extremes/random_carving.h"
#include "tests/support/self_intersection.h"

namespace kerf {
namespace {

struct Row {
  std::vector<double> errors;
  double worst = 0;
  unsigned worst_seed = 0, jobs = 0;
  std::size_t far = 0, crossings = 0;
};

void add(unsigned seed, const Tool& tool, Rays rays, Row& row) {
  test::ToolJob job(seed, tool, rays);
  const auto meshes = test::mesh_all(job.sculpture.solid());
  row.crossings += test::count_self_intersections(meshes, 2 * test::ToolJob::kPitchMm).pairs;
  ++row.jobs;
  for (const double error : job.errors(meshes)) {
    row.errors.push_back(error);
    row.far += error > 0.5 ? 1 : 0;
    if (error <= row.worst) continue;
    row.worst = error;
    row.worst_seed = seed;
  }
}

void print(const char* name, Rays rays, Row& row) {
  std::ranges::sort(row.errors);
  const auto share = [&](double s) {
    return row.errors[std::size_t(s * double(row.errors.size() - 1))];
  };
  std::printf(
      "%-10s %-9s %5u jobs %8zu vertices  max %.3f (seed %4u)  99.9 %% %.3f  99 %% %.4f  "
      "beyond half %3zu  crossings %zu\n",
      name, to_string(rays), row.jobs, row.errors.size(), row.worst, row.worst_seed, share(0.999),
      share(0.99), row.far, row.crossings);
}

}  // namespace

void print_vertex_errors(unsigned first, unsigned jobs) {
  const auto tools = test::every_tool(test::ToolJob::kToolScale);
  const auto kinds = static_cast<unsigned>(2 * tools.size());
  std::vector<Row> rows(kinds);
  Row all[2];
  for (unsigned n = first; n < first + jobs; ++n) {
    add(n, tools[n % kinds / 2].tool, n % 2 == 0 ? Rays::kDexel : Rays::kTriDexel, rows[n % kinds]);
  }
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    Row& sum = all[rays == Rays::kDexel ? 0 : 1];
    for (unsigned k = rays == Rays::kDexel ? 0 : 1; k < kinds; k += 2) {
      Row& row = rows[k];
      if (row.errors.empty()) continue;
      print(tools[k / 2].name.c_str(), rays, row);
      sum.errors.insert(sum.errors.end(), row.errors.begin(), row.errors.end());
      sum.jobs += row.jobs;
      sum.far += row.far;
      sum.crossings += row.crossings;
      if (row.worst > sum.worst) {
        sum.worst = row.worst;
        sum.worst_seed = row.worst_seed;
      }
    }
    if (!sum.errors.empty()) print("all", rays, sum);
  }
}

}  // namespace kerf
