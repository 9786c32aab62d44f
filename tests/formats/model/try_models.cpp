// SPDX-License-Identifier: Apache-2.0
// Reads models of other programs like a stock, and prints a line for each: accepted, accepted after
// a repair, or rejected with the reason; its size, and the volume enclosed by its triangles.
// Run by hand: find FOLDER -iname '*.stl' -print0 | xargs -0 try_models

#include <cstdio>
#include <string>

#include "kernel/dexel/mesh_stock.h"
#include "server/formats/model/mesh_reader.h"
#include "server/formats/model/repair_mesh.h"
#include "server/formats/text_file.h"

namespace {

using namespace kerf;

double volume_mm3(const TriangleMesh& mesh) {
  double six = 0;
  const Vec3 origin = mesh.vertices_mm.front();
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices_mm[t[0]] - origin, b = mesh.vertices_mm[t[1]] - origin,
               c = mesh.vertices_mm[t[2]] - origin;
    six += dot(a, cross(b, c));
  }
  return six / 6;
}

/// Prints: verdict, triangles, size, volume, reason or repair, file; separated by tabs.
void report(const char* verdict, const TriangleMesh& mesh, const std::string& text,
            const std::string& file) {
  const BoxStock box = mesh.triangles.empty() ? BoxStock{} : mesh_bounds(mesh);
  const Vec3 size = box.max_mm - box.min_mm;
  std::printf("%s\t%zu\t%.6g x %.6g x %.6g\t%.6g\t%s\t%s\n", verdict, mesh.triangles.size(), size.x,
              size.y, size.z, mesh.triangles.empty() ? 0 : volume_mm3(mesh), text.c_str(),
              file.c_str());
}

void try_model(const std::string& file) {
  const auto format = mesh_file_format(file);
  const auto bytes = read_file(file);
  if (!format || !bytes) return report("unreadable", {}, "", file);
  auto mesh = read_mesh(*format, std::as_bytes(std::span(*bytes)));
  if (!mesh) return report("refused", {}, mesh.error().reason, file);
  const std::string fault = mesh_stock_fault(*mesh);
  if (fault.empty()) return report("taken", *mesh, "", file);
  const auto repair = repair_mesh(*mesh);
  if (repair) return report("repaired", *mesh, to_string(*repair), file);
  report("refused", {}, repair.error(), file);
}

}  // namespace

int main(int count, char** files) {
  for (int n = 1; n < count; ++n) try_model(files[n]);
  return 0;
}
