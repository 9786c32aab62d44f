// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>

#include "server/formats/machine_kinematics.h"
#include "server/formats/number_text.h"
#include "server/formats/pose_grid.h"
#include "server/formats/program_writing.h"
#include "server/formats/tool_text.h"

namespace kerf {
namespace {

constexpr int kAngleDecimals = 6;
// Most halvings of one motion of a rotary machine; pieces are then as small as the angle step.
constexpr int kTurnHalvingsMax = 16;
// When the C axis has turned this far, the tool is retracted and C is turned back to within one
// turn. LinuxCNC's sample machines allow 100 turns; cables and hoses of real tables allow fewer.
constexpr double kWindUpMaxDeg = 20 * 360;

// The text of a comment, which the first parenthesis would end.
std::string comment_text(const std::string& text) {
  std::string result = printable(text);
  for (char& c : result) c = c == '(' ? '[' : c == ')' ? ']' : c;
  return result;
}

class GcodeWriter final : public ProgramWriter {
 public:
  GcodeWriter(const Scene& scene, std::ostream& out)
      : scene_(scene),
        out_(out),
        kind_(scene.machine.kinematics),
        rotary_(has_rotary_table(kind_)),
        vector_(kind_ == MachineKinematics::kToolVector) {}

  void note(const std::string& line) override { notes_ += '(' + comment_text(line) + ")\n"; }

  WriteResult add(const ProgramMotion& given) override {
    if (!started_) header();
    ProgramMotion motion = given;
    motion.duration_s = std::max(given.duration_s, kWrittenDurationMinS);
    const ToolPose from = admit_pose(motion.from);
    const ToolPose to = admit_pose(motion.to);
    if (kind_ == MachineKinematics::kXyz)
      for (const Vec3& axis : {from.axis, to.axis})
        if (axis.x != 0 || axis.y != 0 || axis.z < 0)
          return std::unexpected(
              "the tool is tilted, which the scene's machine xyz cannot do; use a scene with the "
              "machine tool-vector, xyzac-trt or xyzbc-trt");
    const bool wound_up = std::abs(angles_.c) > kWindUpMaxDeg;
    if (wound_up) angles_.c = std::remainder(angles_.c, 360.0);
    if (!placed_ || wound_up || !(from == last_) || motion.tool != tool_) place(from, motion.tool);
    if (from == to) {
      out_ << "G4 P" << exact_text(motion.duration_s) << '\n';
    } else if (rotary_) {
      turn(from, to, motion, 0);
    } else {
      block(to, motion.rapid, motion.duration_s);
    }
    last_ = to;
    return write_result(out_);
  }

  WriteResult finish() override {
    if (!started_) header();
    if (placed_) retract();
    out_ << "M2\n%\n";
    out_.flush();
    return write_result(out_);
  }

 private:
  void header() {
    started_ = true;
    out_ << "%\n(" << comment_text(scene_.name) << ")\n(written by Kerf for a machine "
         << to_string(kind_) << "; mm; coordinates are those of the tool tip)\n";
    for (const auto& [id, tool] : scene_.tools)
      out_ << "(T" << id << ": " << tool_text(tool.shape) << ")\n";
    out_ << (rotary_ ? "(the tip is exact to 0.000001 mm, angles to 0.000001 degrees, durations to "
                       "1e-6 relative)\n"
                     : "(poses read back bit-identical; durations are exact to 1e-6 relative)\n")
         << notes_ << "(G53 G0 Z0 must be a safe height; the operator sets the spindle speed)\n"
         << "G21 G17 G90 G40 G49 G80 G54 " << (inverse_time() ? "G93" : "G94") << '\n';
  }

  bool inverse_time() const { return rotary_ || vector_; }

  void retract() {
    if (tcp_on_) out_ << "M429\n";
    tcp_on_ = false;
    out_ << "G53 G0 Z0\n";
    motion_ = "G0";
  }

  // Brings the tool to a pose without cutting: retract to the top of Z, traverse, plunge. The
  // readers read this as a jump.
  void place(const ToolPose& pose, ToolId tool) {
    retract();
    if (!placed_ || tool != tool_) out_ << 'T' << tool << " M6\n";
    tool_ = tool;
    placed_ = true;
    if (rotary_) {
      // The tables turn with tool-center-point control off, so that the retracted tool does not
      // move with them.
      angles_ = angles_from_axis(kind_, normalized(pose.axis), angles_);
      out_ << "G0" << rotary_words(angles_) << "\nM428\n";
      tcp_on_ = true;
    }
    out_ << "G0 X" << exact_text(pose.tip_mm.x) << " Y" << exact_text(pose.tip_mm.y);
    if (vector_) out_ << vector_words(pose.axis);
    out_ << "\nG0 Z" << exact_text(pose.tip_mm.z) << '\n';
    last_ = pose;
  }

  static std::string vector_words(Vec3 axis) {
    return " I" + exact_text(axis.x) + " J" + exact_text(axis.y) + " K" + exact_text(axis.z);
  }
  std::string rotary_words(const RotaryAngles& angles) const {
    const bool ac = kind_ == MachineKinematics::kXyzacTrt;
    return (ac ? " A" + decimal_text(angles.a, kAngleDecimals)
               : " B" + decimal_text(angles.b, kAngleDecimals)) +
           " C" + decimal_text(angles.c, kAngleDecimals);
  }

  // Writes a motion of a rotary machine, which interpolates its angles. Halves it until that
  // deviates from the great circle by no more than the tolerance at the end of the tool.
  void turn(const ToolPose& from, const ToolPose& to, const ProgramMotion& motion, int halvings) {
    const Vec3 a = normalized(from.axis);
    const Vec3 b = normalized(to.axis);
    const RotaryAngles end = angles_from_axis(kind_, b, angles_);
    double deviation = 0;
    for (const double s : {0.25, 0.5, 0.75}) {
      const RotaryAngles angles{angles_.a + (end.a - angles_.a) * s,
                                angles_.b + (end.b - angles_.b) * s,
                                angles_.c + (end.c - angles_.c) * s};
      deviation = std::max(deviation, length(table_axis(kind_, angles) - turned_axis(a, b, s)));
    }
    const double reach = reach_mm(scene_, motion.tool);
    if (deviation * reach > scene_.settings.tolerance_mm && halvings < kTurnHalvingsMax) {
      const ToolPose middle = admit_pose({(from.tip_mm + to.tip_mm) * 0.5, turned_axis(a, b, 0.5)});
      turn(from, middle, motion, halvings + 1);
      turn(middle, to, motion, halvings + 1);
      return;
    }
    last_ = from;
    end_angles_ = end;
    block(to, motion.rapid, motion.duration_s / (1 << halvings));
    angles_ = end;
    last_ = to;
  }

  void block(const ToolPose& to, bool rapid, double duration_s) {
    std::string words;
    const auto axis_word = [&words](char letter, double before, double after) {
      if (before != after) words += std::string(" ") + letter + exact_text(after);
    };
    axis_word('X', last_.tip_mm.x, to.tip_mm.x);
    axis_word('Y', last_.tip_mm.y, to.tip_mm.y);
    axis_word('Z', last_.tip_mm.z, to.tip_mm.z);
    if (vector_ && !(last_.axis == to.axis)) words += vector_words(to.axis);
    if (rotary_ && !(last_.axis == to.axis)) words += rotary_words(end_angles_);
    if (words.empty()) return;
    const std::string code = rapid ? "G0" : "G1";
    std::string text = code == motion_ ? words : code + words;
    if (!rapid) text += feed_word(to, duration_s);
    motion_ = code;
    out_ << (text.front() == ' ' ? text.substr(1) : text) << '\n';
  }

  std::string feed_word(const ToolPose& to, double duration_s) {
    if (inverse_time()) return " F" + significant_text(60 / duration_s, kFeedDigits);
    const double travel_mm = length(to.tip_mm - last_.tip_mm);
    std::string feed = significant_text(60 * travel_mm / duration_s, kFeedDigits);
    if (feed == feed_) return "";
    feed_ = std::move(feed);
    return " F" + feed_;
  }

  const Scene& scene_;
  std::ostream& out_;
  const MachineKinematics kind_;
  const bool rotary_, vector_;
  bool started_ = false, placed_ = false, tcp_on_ = false;
  ToolId tool_ = 0;
  ToolPose last_;
  RotaryAngles angles_, end_angles_;
  std::string motion_, feed_, notes_;
};

}  // namespace

std::unique_ptr<ProgramWriter> make_gcode_writer(const Scene& scene, std::ostream& out) {
  return std::make_unique<GcodeWriter>(scene, out);
}

}  // namespace kerf
