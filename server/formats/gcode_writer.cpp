// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <ostream>
#include <tuple>
#include <utility>

#include "server/formats/gcode_comment.h"
#include "server/formats/number_text.h"
#include "server/formats/post_parts.h"
#include "server/formats/post_writer.h"
#include "server/formats/tool_text.h"

namespace kerf {
namespace {

/// Fanuc's largest dwell without a decimal point, ms.
constexpr double kDwellMaxMs = 99'999'999;

class GcodeWriter final : public PostWriter {
 public:
  GcodeWriter(Post post, const Scene& scene, std::ostream& out)
      : PostWriter(rules_of(post), scene, out),
        post_(post),
        iso_(post == Post::kFanuc || post == Post::kHaas),
        inverse_time_(post == Post::kLinuxcnc && (rotary() || vector())) {}

  void set_number(const std::string& digits) override { number_of_program_ = digits; }

 private:
  void begin() override {
    if (post_ != Post::kGrbl) out() << "%\n";
    if (iso_) {
      const std::string assumed = post_ == Post::kHaas ? "01000" : "1000";
      out() << "O" << (number_of_program_.empty() ? assumed : number_of_program_) << ' '
            << comment(scene().name);
    } else {
      out() << comment(scene().name);
    }
    out() << '\n'
          << comment("written by Kerf for " + std::string(rules().label) + " and a machine " +
                     to_string(kind()) + "; mm; coordinates are those of the tool tip")
          << '\n';
    for (const auto& [id, tool] : scene().tools)
      for (const std::string& text : tool_comments(id, tool.shape)) out() << comment(text) << '\n';
    out() << comment(precision()) << '\n';
    for (const std::string& note : notes()) out() << comment(note) << '\n';
    out() << comment(caution()) << '\n';
    out() << (post_ == Post::kGrbl ? "G21 G17 G90 G94 G54" : "G21 G17 G90 G40 G49 G80 G54 ");
    if (post_ != Post::kGrbl) out() << (inverse_time_ ? "G93" : "G94");
    out() << '\n';
  }

  std::string precision() const {
    if (post_ == Post::kLinuxcnc)
      return rotary() ? "the tip is exact to 0.000001 mm, angles to 0.000001 degrees, durations to "
                        "1e-6 relative"
                      : "poses read back bit-identical; durations are exact to 1e-6 relative";
    return rotary() ? "rounded to 0.001 mm and 0.001 degrees, feeds to 4 digits"
                    : "rounded to 0.001 mm, feeds to 4 digits";
  }

  std::string caution() const {
    if (post_ == Post::kGrbl)
      return "home first: G53 G0 Z0 must be a safe height; set Z zero again after M0";
    if (post_ == Post::kFanuc)
      return rotary() || vector()
                 ? "G28 Z must be a safe height; G49 must not move the machine: 5006 bit 6 = 1"
                 : "G28 Z must be a safe height; H holds the length of each tool";
    return "G53 G0 Z0 must be a safe height; H holds the length of each tool; where no S and M3 "
           "stand, the operator starts the spindle";
  }

  std::string comment(const std::string& text) const { return gcode_comment(post_, text); }

  void retract() override {
    select_plane(ArcPlane::kXy);
    if (tcp_on_) out() << (iso_ ? "G49\n" : "M429\n");
    tcp_on_ = false;
    if (post_ == Post::kFanuc) {
      out() << "G91 G28 Z0.\nG90\n";
    } else {
      out() << "G53 G0 Z" << number(0) << '\n';
    }
    motion_.clear();
  }

  void change_tool(bool first) override {
    length_on_ = false;
    if (post_ != Post::kGrbl) {
      out() << 'T' << tool() << " M6\n";
      return;
    }
    if (!first && turning_) out() << "M5\n";
    out() << 'T' << tool() << '\n';
    if (first) return;
    out() << comment("insert T" + std::to_string(tool())) << "\nM0\n";
    if (turning_) say(*turning_);
  }

  // The tables turn with tool-center-point control off, so that the retracted tool does not move
  // with them. X and Y follow, so that the tool then descends along its axis only.
  void approach(const ToolPose& pose) override {
    const Vec3& tip = pose.tip_mm;
    const bool follows = rotary() || (vector() && iso_);
    if (rotary()) out() << "G0" << rotary_words(angles()) << '\n';
    const Vec3 above = rotary() ? programmed_from_tip(scene().machine, false, tip, angles()) : tip;
    const auto rounded = [this](double value) {
      return pointed(decimal_text(value, rules().tip_decimals));
    };
    out() << "G0 X" << rounded(above.x) << " Y" << rounded(above.y);
    if (vector() && !iso_) out() << vector_words(pose.axis);
    out() << '\n';
    if (follows) {
      tcp_on_ = true;
      if (iso_) {
        out() << "G0 " << tcp_code() << " H" << tool();
      } else {
        if (!std::exchange(length_on_, true)) out() << "G43 H" << tool() << '\n';
        out() << "M428\nG0";
      }
      out() << " X" << number(tip.x) << " Y" << number(tip.y);
      if (vector()) out() << vector_words(pose.axis);
    } else {
      out() << "G0";
      if (post_ != Post::kGrbl && !std::exchange(length_on_, post_ != Post::kFanuc))
        out() << " G43 H" << tool();
    }
    out() << " Z" << number(tip.z) << '\n';
    motion_ = "G0";
  }

  std::string tcp_code() const {
    return post_ == Post::kHaas ? "G234" : vector() ? "G43.5" : "G43.4";
  }

  void straight(const ToolPose& to, bool rapid, double duration_s) override {
    std::string words;
    const auto axis_word = [&](char letter, double before, double after) {
      if (before != after) words += std::string(" ") + letter + number(after);
    };
    axis_word('X', last().tip_mm.x, to.tip_mm.x);
    axis_word('Y', last().tip_mm.y, to.tip_mm.y);
    axis_word('Z', last().tip_mm.z, to.tip_mm.z);
    if (vector() && !(last().axis == to.axis)) words += vector_words(to.axis);
    if (rotary() && !(last().axis == to.axis)) words += rotary_words(end_angles());
    if (words.empty()) return;
    const std::string code = rapid ? "G0" : "G1";
    std::string text = code == motion_ ? words : code + words;
    if (!rapid) text += feed_word(to, duration_s);
    motion_ = code;
    out() << (text.front() == ' ' ? text.substr(1) : text) << '\n';
  }

  void arc(const ToolPose& to, const FittedArc& arc, double duration_s) override {
    const Vec3 from = last().tip_mm, tip = to.tip_mm;
    select_plane(arc.plane);
    motion_ = arc.counterclockwise ? "G3" : "G2";
    out() << motion_;
    for (const auto& [letter, before, after] :
         {std::tuple{'X', from.x, tip.x}, {'Y', from.y, tip.y}, {'Z', from.z, tip.z}})
      if (before != after) out() << ' ' << letter << number(after);
    const PlanePoint start = in_plane(from, arc.plane);
    const Vec3 center = from_plane(
        {arc.center.first - start.first, arc.center.second - start.second, 0}, arc.plane);
    const auto offset = [this](double mm) {
      return pointed(decimal_text(mm, rules().tip_decimals));
    };
    if (arc.plane != ArcPlane::kYz) out() << " I" << offset(center.x);
    if (arc.plane != ArcPlane::kZx) out() << " J" << offset(center.y);
    if (arc.plane != ArcPlane::kXy) out() << " K" << offset(center.z);
    out() << feed_text(60 * arc_length_mm(arc, from, tip) / duration_s) << '\n';
  }

  /// grbl has no canned cycles.
  bool drills(const DrilledHole& hole) const override {
    const double least = std::pow(10.0, -rules().tip_decimals);
    return kind() == MachineKinematics::kXyz && post_ != Post::kGrbl &&
           (hole.peck_mm == 0 || hole.peck_mm >= least);
  }

  // Each hole after the first has only its position.
  void drill(const DrilledHole& hole) override {
    select_plane(ArcPlane::kXy);
    const std::string cycle =
        (hole.clear_mm == hole.r_mm ? "G99 G" : "G98 G") + std::to_string(hole.code);
    std::string words = " Z" + number(hole.bottom_mm) + " R" + number(hole.r_mm);
    if (hole.peck_mm > 0) words += " Q" + number(hole.peck_mm);
    if (hole.code == 82) words += dwell_word(hole.dwell_s);
    feed_.clear();
    words += feed_text(hole.mm_per_min);
    const std::string place = "X" + number(hole.x_mm) + " Y" + number(hole.y_mm);
    if (cycle_ == cycle + words) {
      out() << place << '\n';
      return;
    }
    if (!cycle_.empty()) end_drilling();
    out() << cycle << ' ' << place << words << '\n';
    cycle_ = cycle + words;
  }

  void end_drilling() override {
    out() << "G80\n";
    cycle_.clear();
    motion_.clear();
  }

  void select_plane(ArcPlane plane) {
    if (plane == plane_) return;
    plane_ = plane;
    out() << (plane == ArcPlane::kXy ? "G17\n" : plane == ArcPlane::kZx ? "G18\n" : "G19\n");
  }

  std::string feed_word(const ToolPose& to, double duration_s) {
    if (inverse_time_) return " F" + significant_text(60 / duration_s, rules().feed_digits);
    return feed_text(feed(to, duration_s));
  }

  std::string feed_text(double per_min) {
    std::string written = pointed(significant_text(per_min, rules().feed_digits));
    if (written == feed_) return "";
    feed_ = std::move(written);
    return " F" + feed_;
  }

  void dwell(double seconds) override { out() << "G4" << dwell_word(seconds) << '\n'; }

  std::string dwell_word(double seconds) const {
    if (!iso_) return " P" + exact_text(seconds);
    return " P" + decimal_text(std::clamp(std::round(1000 * seconds), 1.0, kDwellMaxMs), 0);
  }

  void say(const MachineRemark& said) override {
    using Kind = MachineRemark::Kind;
    const std::string speed =
        said.rpm > 0 ? "S" + significant_text(said.rpm, kFeedDigits) + ' ' : std::string();
    switch (said.kind) {
      case Kind::kSpindleClockwise:
      case Kind::kSpindleCounterClockwise:
        turning_ = said;
        out() << speed << (said.kind == Kind::kSpindleClockwise ? "M3\n" : "M4\n");
        return;
      case Kind::kSpindleStop:
        turning_.reset();
        out() << "M5\n";
        return;
      case Kind::kMist:
        out() << (post_ == Post::kHaas ? "M8\n" : "M7\n");
        return;
      case Kind::kFlood:
        out() << "M8\n";
        return;
      case Kind::kCoolantOff:
        out() << "M9\n";
        return;
      case Kind::kStop:
        out() << "M0\n";
        return;
      case Kind::kOptionalStop:
        out() << "M1\n";
        return;
      case Kind::kComment:
        out() << comment(said.text) << '\n';
    }
  }

  void end() override {
    out() << (iso_ ? "M30\n" : "M2\n");
    if (post_ != Post::kGrbl) out() << "%\n";
  }

  // Fanuc and Haas read a number without a point as a count of least increments.
  std::string pointed(std::string text) const {
    if (iso_ && text.find('.') == std::string::npos) text += '.';
    return text;
  }
  std::string number(double value) const {
    return post_ == Post::kLinuxcnc ? exact_text(value)
                                    : pointed(decimal_text(value, rules().tip_decimals));
  }
  std::string vector_words(Vec3 axis) const {
    const auto text = [this](double value) {
      return post_ == Post::kLinuxcnc ? exact_text(value)
                                      : pointed(decimal_text(value, rules().axis_decimals));
    };
    return " I" + text(axis.x) + " J" + text(axis.y) + " K" + text(axis.z);
  }
  std::string rotary_words(const RotaryAngles& angles) const {
    const auto text = [this](double deg) {
      return pointed(decimal_text(deg, rules().angle_decimals));
    };
    return (kind() == MachineKinematics::kXyzacTrt ? " A" + text(angles.a)
                                                   : " B" + text(angles.b)) +
           " C" + text(angles.c);
  }

  const Post post_;
  std::string number_of_program_;  ///< in digits; "": none
  const bool iso_, inverse_time_;  ///< iso_: Fanuc and Haas
  bool tcp_on_ = false, length_on_ = false;
  std::optional<MachineRemark> turning_;  ///< the remark that started the spindle
  std::string motion_, feed_;
  std::string cycle_;  ///< the cycle left active by the last hole
  ArcPlane plane_ = ArcPlane::kXy;
};

}  // namespace

std::unique_ptr<ProgramWriter> make_gcode_post(Post post, const Scene& scene, std::ostream& out) {
  return std::make_unique<GcodeWriter>(post, scene, out);
}

}  // namespace kerf
