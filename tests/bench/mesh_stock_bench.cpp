// SPDX-License-Identifier: Apache-2.0
// Measures how fast a mesh becomes a stock, in triangles per second of CPU of one thread: reading
// it (STL and PLY, binary, in memory), checking that it is closed, and dexelising it. The mesh is a
// sphere of 100 mm with waves. Usage: mesh_stock_bench [triangles=4000000] [pitch_mm=0.1]
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/mesh_stock.h"
#include "kernel/dexel/stock_column.h"
#include "server/formats/model/mesh_reader.h"
#include "tests/bench/cpu_clock.h"

namespace {

using namespace kerf;

struct Sphere {
  std::vector<float> corners;          ///< x y z of each vertex
  std::vector<std::uint32_t> indices;  ///< three of each triangle
};

// Rings of triangles between two poles.
Sphere wavy_sphere(std::size_t triangles) {
  const auto rings = static_cast<std::uint32_t>(std::sqrt(double(triangles) / 4)) + 2;
  const std::uint32_t around = 2 * rings;
  Sphere mesh;
  const auto add = [&](double polar, double angle) {
    const double r = 50 + 2 * std::sin(7 * angle) * std::sin(5 * polar) * std::sin(polar);
    for (const double c :
         {std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar)})
      mesh.corners.push_back(static_cast<float>(r * c));
  };
  add(0, 0);
  for (std::uint32_t ring = 1; ring < rings; ++ring)
    for (std::uint32_t n = 0; n < around; ++n)
      add(std::numbers::pi * ring / rings, 2 * std::numbers::pi * n / around);
  add(std::numbers::pi, 0);
  const auto at = [&](std::uint32_t ring, std::uint32_t n) {
    return 1 + (ring - 1) * around + n % around;
  };
  const auto last = static_cast<std::uint32_t>(mesh.corners.size() / 3) - 1;
  for (std::uint32_t n = 0; n < around; ++n) {
    for (const std::uint32_t v : {0U, at(1, n), at(1, n + 1)}) mesh.indices.push_back(v);
    for (std::uint32_t ring = 1; ring + 1 < rings; ++ring)
      for (const std::uint32_t v : {at(ring, n), at(ring + 1, n), at(ring + 1, n + 1), at(ring, n),
                                    at(ring + 1, n + 1), at(ring, n + 1)})
        mesh.indices.push_back(v);
    for (const std::uint32_t v : {last, at(rings - 1, n + 1), at(rings - 1, n)})
      mesh.indices.push_back(v);
  }
  return mesh;
}

template <typename T>
void put(std::string& to, const T& value) {
  to.append(std::bit_cast<std::array<char, sizeof(T)>>(value).data(), sizeof(T));
}

std::string stl_of(const Sphere& mesh) {
  std::string file(80, ' ');
  put(file, static_cast<std::uint32_t>(mesh.indices.size() / 3));
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    file.append(12, '\0');  // the normal, which readers compute
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t axis = 0; axis < 3; ++axis)
        put(file, mesh.corners[3 * mesh.indices[n + c] + axis]);
    file.append(2, '\0');
  }
  return file;
}

std::string ply_of(const Sphere& mesh) {
  std::string file = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                     std::to_string(mesh.corners.size() / 3) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                     std::to_string(mesh.indices.size() / 3) +
                     "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const float c : mesh.corners) put(file, c);
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    put(file, static_cast<unsigned char>(3));
    for (std::size_t c = 0; c < 3; ++c) put(file, mesh.indices[n + c]);
  }
  return file;
}

// Runs a step and prints its speed; returns its time.
template <typename Step>
double timed(const char* name, std::size_t triangles, const Step& step) {
  const double start = test::cpu_seconds();
  step();
  const double seconds = test::cpu_seconds() - start;
  std::printf("  %-22s %6.2f s  %6.2f M triangles/s\n", name, seconds,
              1e-6 * double(triangles) / seconds);
  return seconds;
}

void measure(MeshFileFormat format, const char* name, const std::string& file, double pitch_mm) {
  std::printf("%s, %.0f MB\n", name, 1e-6 * double(file.size()));
  TriangleMesh mesh;
  const double start = test::cpu_seconds();
  {
    auto result = read_mesh(format, std::as_bytes(std::span(file)));
    if (!result) std::exit(1);
    mesh = *std::move(result);
  }
  const double read = test::cpu_seconds() - start;
  const std::size_t count = mesh.triangles.size();
  std::printf("  %zu triangles\n  %-22s %6.2f s  %6.2f M triangles/s\n", count, "read", read,
              1e-6 * double(count) / read);
  const double check = timed("check that it is closed", count, [&] {
    if (const std::string fault = mesh_stock_fault(mesh); !fault.empty()) {
      std::fprintf(stderr, "%s\n", fault.c_str());
      std::exit(1);
    }
  });
  const DexelGrid grid = make_grid(mesh_bounds(mesh), pitch_mm);
  std::size_t tiles = 0;
  const double dexels = timed("dexelise", count, [&] {
    dexelize(mesh, grid, true, [&](TileIndex, const std::shared_ptr<DexelTile>&) { ++tiles; });
  });
  std::printf("  %d x %d columns, %zu tiles; all three: %.2f M triangles/s\n", grid.columns_x,
              grid.columns_y, tiles, 1e-6 * double(count) / (read + check + dexels));
}

}  // namespace

int main(int argc, char** argv) {
  const double triangles = argc > 1 ? std::atof(argv[1]) : 4e6;
  const double pitch_mm = argc > 2 ? std::atof(argv[2]) : 0.1;
  if (!(triangles >= 8 && triangles <= 2e7 && pitch_mm > 0)) {
    std::fprintf(stderr, "usage: mesh_stock_bench [triangles <= 2e7] [pitch_mm]\n");
    return 2;
  }
  const Sphere sphere = wavy_sphere(static_cast<std::size_t>(triangles));
  measure(MeshFileFormat::kStl, "STL", stl_of(sphere), pitch_mm);
  measure(MeshFileFormat::kPly, "PLY", ply_of(sphere), pitch_mm);
}
