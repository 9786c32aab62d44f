// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_writer.h"

#include <cmath>
#include <ostream>
#include <utility>

#include "server/formats/drilling_cycles.h"
#include "server/formats/kept_arcs.h"
#include "server/formats/post_parts.h"
#include "server/formats/program_decimator.h"
#include "server/formats/program_writing.h"

namespace kerf {
namespace {

/// Decimals of the pose grid (kTipGridMm).
constexpr int kPoseDecimals = 6;

// The last decimal that a control accepts, mm, or 0 if it accepts all.
double rounding_mm(int decimals) {
  return decimals >= kPoseDecimals ? 0 : std::pow(10.0, -decimals);
}

}  // namespace

WriteResult ProgramWriter::add_arc(const ProgramMotion&, const FittedArc&) {
  return std::unexpected("the language has no arcs");
}

WriteResult ProgramWriter::add_hole(const ProgramMotion&, const DrilledHole&) {
  return std::unexpected("the language has no drilling cycles");
}

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

std::optional<std::string> post_rejection(Post post, MachineKinematics kinematics) {
  const bool vectors = kinematics == MachineKinematics::kToolVector;
  const bool refused = post == Post::kGrbl
                           ? kinematics != MachineKinematics::kXyz
                           : vectors && (post == Post::kHaas || post == Post::kHeidenhain);
  if (!refused) return std::nullopt;
  return "a program for " + std::string(rules_of(post).label) +
         " cannot be written for the scene's machine " + to_string(kinematics) +
         "; use a scene with the machine " +
         (post == Post::kGrbl ? "xyz" : "xyz, xyzac-trt or xyzbc-trt");
}

std::expected<std::unique_ptr<ProgramWriter>, std::string> make_post_writer(Post post,
                                                                            const Scene& scene,
                                                                            std::ostream& out) {
  if (auto refused = post_rejection(post, scene.machine.kinematics))
    return std::unexpected(*std::move(refused));
  if (post == Post::kHeidenhain) return make_klartext_post(scene, out);
  return make_gcode_post(post, scene, out);
}

std::unique_ptr<ProgramWriter> make_gcode_writer(const Scene& scene, std::ostream& out) {
  return make_gcode_post(Post::kLinuxcnc, scene, out);
}

std::expected<std::unique_ptr<ProgramWriter>, std::string> make_program_writer(
    const ProgramStyle& style, const Scene& scene, std::ostream& out) {
  const bool apt = style.format == ProgramFormat::kApt;
  auto made = apt ? make_apt_writer(scene, out) : make_post_writer(style.post, scene, out);
  if (!made) return std::unexpected(made.error());
  std::unique_ptr<ProgramWriter> writer = *std::move(made);
  if (style.tolerance_mm > 0)
    writer = std::make_unique<ProgramDecimator>(std::move(writer), scene, style.tolerance_mm);
  else if (!apt)
    writer = std::make_unique<KeptArcs>(std::move(writer), scene,
                                        rounding_mm(rules_of(style.post).tip_decimals));
  // Holes are found before motions are joined across their ends.
  if (!apt) writer = std::make_unique<DrillingCycles>(std::move(writer));
  return writer;
}

WriteResult write_program(const Program& program, ProgramWriter& writer) {
  if (!program.number.empty()) writer.set_number(program.number);
  auto remark = program.remarks.begin();
  const auto say_until = [&](std::size_t motions) -> WriteResult {
    for (; remark != program.remarks.end() && remark->motions <= motions; ++remark)
      if (WriteResult written = writer.remark(remark->said); !written) return written;
    return {};
  };
  for (std::size_t n = 0; n < program.motions.size(); ++n) {
    if (WriteResult written = say_until(n); !written) return written;
    if (WriteResult written = writer.add(program.motions[n]); !written) return written;
  }
  if (WriteResult written = say_until(program.motions.size()); !written) return written;
  return writer.finish();
}

}  // namespace kerf
