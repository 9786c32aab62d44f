// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_writer.h"

#include <ostream>

#include "server/formats/program_decimator.h"
#include "server/formats/program_writing.h"

namespace kerf {

WriteResult write_result(const std::ostream& out) {
  if (out.good()) return {};
  return std::unexpected("writing to the output stream failed");
}

std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

double reach_mm(const Scene& scene, ToolId tool) {
  const auto it = scene.tools.find(tool);
  return it != scene.tools.end() ? it->second.tool.length_mm : scene.settings.force.pivot_mm;
}

std::unique_ptr<ProgramWriter> make_program_writer(ProgramFormat format, const Scene& scene,
                                                   std::ostream& out, double tolerance_mm) {
  auto writer =
      format == ProgramFormat::kApt ? make_apt_writer(scene, out) : make_gcode_writer(scene, out);
  if (!(tolerance_mm > 0)) return writer;
  return std::make_unique<ProgramDecimator>(std::move(writer), scene, tolerance_mm);
}

WriteResult write_program(const Program& program, ProgramWriter& writer) {
  for (const ProgramMotion& motion : program.motions)
    if (WriteResult written = writer.add(motion); !written) return written;
  return writer.finish();
}

}  // namespace kerf
