// SPDX-License-Identifier: Apache-2.0
// carve [OUT.stl]: mills a pocket floor into a block with a 6 mm ball end mill and prints the
// removed volume.
#include <kerf/formats/model/model_writer.h>
#include <kerf/kernel/sculpture.h>

#include <cstdio>

int main(int argc, char** argv) {
  kerf::SculptureSettings settings;
  settings.stock = kerf::BoxStock{{0, 0, 0}, {40, 30, 10}};
  auto block = kerf::Sculpture::create(settings).value();
  block.apply(kerf::DefineTool{1, kerf::make_tool(kerf::BallShape{6, 20}).value()}).value();

  for (double y = 5; y <= 25; y += 1) {
    block.apply(kerf::MoveTool{1, {{5, y, 8}}, {{35, y, 8}}, 1.0}).value();
  }
  std::printf("removed %.1f mm3 of %.1f mm3\n", block.removed_volume_mm3(),
              block.stock_volume_mm3());

  if (argc < 2) return 0;
  kerf::SnapshotMesh surface(block.solid());
  const auto written = kerf::write_model(argv[1], surface, {.format = kerf::ModelFormat::kStl});
  if (!written) return std::fprintf(stderr, "%s\n", written.error().reason.c_str()), 1;
  std::printf("%s: %llu triangles\n", argv[1], static_cast<unsigned long long>(written->triangles));
  return 0;
}
