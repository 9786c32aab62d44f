// SPDX-License-Identifier: Apache-2.0
// kerf-demo: writes the APT programs of the demo's two agents.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "haptic_agent/demo/carving.h"

namespace {

bool write_program(const std::filesystem::path& file, const std::string& name,
                   const std::vector<kerf::demo::Stroke>& strokes) {
  std::ofstream out(file, std::ios::binary);
  out << kerf::demo::apt_text(name, strokes, kerf::demo::kRetractMm);
  out.close();
  if (!out) {
    std::fprintf(stderr, "kerf-demo: %s cannot be written\n", file.c_str());
    return false;
  }
  std::size_t poses = 0;
  for (const auto& stroke : strokes) poses += stroke.poses.size();
  std::printf("%s: %zu poses, %.0f s of cutting\n", file.c_str(), poses,
              kerf::demo::cutting_seconds(strokes));
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || argv[1][0] == '-') {
    std::fprintf(stderr,
                 "usage: kerf-demo FOLDER\nwrites FOLDER/first.apt and FOLDER/second.apt, "
                 "to be carved at the same time\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const auto carving = kerf::demo::carve(kerf::demo::Ammonite{});
  const bool written =
      write_program(folder / "first.apt", "AMMONITE WHORL", carving.first) &&
      write_program(folder / "second.apt", "AMMONITE DISH AND COIL", carving.second);
  return written ? 0 : 1;
}
