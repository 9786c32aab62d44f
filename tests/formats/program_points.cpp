// program_points SCENE PROGRAM: where each motion ends, one line each: "line x y z i j k seconds",
// or "error: …".
#include <cstdio>

#include "server/formats/program.h"
#include "server/formats/text_file.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto scene = kerf::load_scene(argv[1]);
  const auto text = kerf::read_file(argv[2]);
  if (!scene || !text) return 2;
  const auto program = kerf::parse_program(argv[2], *text, *scene);
  if (!program) {
    std::printf("error: %s\n", kerf::to_string(program.error()).c_str());
    return 1;
  }
  for (const kerf::ProgramMotion& m : program->motions)
    std::printf("%u %.6f %.6f %.6f %.9f %.9f %.9f %.9g\n", m.line, m.to.tip_mm.x, m.to.tip_mm.y,
                m.to.tip_mm.z, m.to.axis.x, m.to.axis.y, m.to.axis.z, m.duration_s);
  return 0;
}
