// SPDX-License-Identifier: Apache-2.0
#include <cctype>
#include <optional>
#include <ostream>
#include <utility>
#include <variant>

#include "server/formats/number_text.h"
#include "server/formats/post_parts.h"
#include "server/formats/post_writer.h"
#include "server/formats/tool_text.h"

namespace kerf {
namespace {

constexpr std::size_t kNameMax = 16;

// A name of a program: capital letters, digits and underscores.
std::string name_of(const std::string& text) {
  std::string name;
  for (const char c : text) {
    if (name.size() == kNameMax) break;
    const auto byte = static_cast<unsigned char>(c);
    name += byte < 0x80 && std::isalnum(byte) != 0 ? static_cast<char>(std::toupper(byte)) : '_';
  }
  return name.empty() ? "KERF" : name;
}

bool starts_spindle(const MachineRemark& said) {
  return said.kind == MachineRemark::Kind::kSpindleClockwise ||
         said.kind == MachineRemark::Kind::kSpindleCounterClockwise;
}

class KlartextWriter final : public PostWriter {
 public:
  KlartextWriter(const Scene& scene, std::ostream& out)
      : PostWriter(rules_of(Post::kHeidenhain), scene, out), name_(name_of(scene.name)) {}

  /// A helix would be CP with an angle, whose end is rounded differently.
  bool takes(const FittedArc& arc) const override {
    return PostWriter::takes(arc) && arc.plane == ArcPlane::kXy && !arc.helical;
  }

 private:
  void block(const std::string& text) { out() << blocks_++ << ' ' << text << '\n'; }
  void comment(const std::string& text) { block("; " + printable(text)); }

  void begin() override {
    block("BEGIN PGM " + name_ + " MM");
    if (const auto* box = std::get_if<BoxStock>(&scene().settings.stock);
        box != nullptr && !scene().settings.stock_mesh) {
      block("BLK FORM 0.1 Z" + point(box->min_mm));
      block("BLK FORM 0.2" + point(box->max_mm));
    }
    comment(scene().name);
    comment(std::string("written by Kerf for a machine ") + to_string(kind()) +
            "; coordinates are those of the tool tip");
    for (const auto& [id, tool] : scene().tools)
      for (const std::string& text : tool_comments(id, tool.shape)) comment(text);
    comment("rounded to 0.0001 mm, feeds to 4 digits");
    for (const std::string& note : notes()) comment(note);
    comment("M140 MB MAX must lead to a safe height; the tool table holds the lengths");
  }

  void retract() override {
    block("L M140 MB MAX");
    if (tcp_on_) block("M129");
    tcp_on_ = false;
  }

  void change_tool(bool) override {
    rpm_ = next_rpm();
    turning_.reset();
    block("TOOL CALL " + std::to_string(tool()) + " Z" + (rpm_ > 0 ? speed_word() : ""));
  }

  void approach(const ToolPose& pose) override {
    const Vec3& tip = pose.tip_mm;
    if (!rotary()) {
      block("L" + word('X', tip.x) + word('Y', tip.y) + " R0 FMAX");
      return block("L" + word('Z', tip.z) + " R0 FMAX");
    }
    const Vec3 above = programmed_from_tip(scene().machine, false, tip, angles());
    block("L" + rotary_words(angles()) + " R0 FMAX");
    block("L" + word('X', above.x) + word('Y', above.y) + " R0 FMAX");
    block("M128");
    tcp_on_ = true;
    block("L" + point(tip) + " R0 FMAX");
  }

  void straight(const ToolPose& to, bool rapid, double duration_s) override {
    std::string words;
    if (last().tip_mm.x != to.tip_mm.x) words += word('X', to.tip_mm.x);
    if (last().tip_mm.y != to.tip_mm.y) words += word('Y', to.tip_mm.y);
    if (last().tip_mm.z != to.tip_mm.z) words += word('Z', to.tip_mm.z);
    if (rotary() && !(last().axis == to.axis)) words += rotary_words(end_angles());
    if (words.empty()) return;
    if (rapid) return block("L" + words + " R0 FMAX");
    block("L" + words + feed_text(feed(to, duration_s)));
  }

  void arc(const ToolPose& to, const FittedArc& arc, double duration_s) override {
    block("CC" + word('X', arc.center.first) + word('Y', arc.center.second));
    const double per_min = 60 * arc_length_mm(arc, last().tip_mm, to.tip_mm) / duration_s;
    block("C" + word('X', to.tip_mm.x) + word('Y', to.tip_mm.y) +
          (arc.counterclockwise ? " DR+" : " DR-") + feed_text(per_min));
  }

  /// The retraction of peck cycles is a setting of the control.
  bool drills(const DrilledHole& hole) const override { return !rotary() && hole.peck_mm == 0; }

  void drill(const DrilledHole& hole) override {
    const std::string cycle = drilling(hole);
    if (std::exchange(cycle_, cycle) != cycle) block(cycle);
    block("L" + word('X', hole.x_mm) + word('Y', hole.y_mm) + " R0 FMAX M99");
  }
  void end_drilling() override { cycle_.clear(); }

  // The surface is assumed at R, because the motions do not show it.
  std::string drilling(const DrilledHole& hole) const {
    const auto mm = [this](double value) { return decimal_text(value, rules().tip_decimals); };
    const double depth_mm = hole.r_mm - hole.bottom_mm;
    return "CYCL DEF 200 DRILLING ~\n  Q200=0 ;SET-UP CLEARANCE ~\n  Q201=" + mm(-depth_mm) +
           " ;DEPTH ~\n  Q206=" + significant_text(hole.mm_per_min, rules().feed_digits) +
           " ;FEED RATE FOR PLNGNG ~\n  Q202=" + mm(depth_mm) +
           " ;PLUNGING DEPTH ~\n  Q210=0 ;DWELL TIME AT TOP ~\n  Q203=" + mm(hole.r_mm) +
           " ;SURFACE COORDINATE ~\n  Q204=" + mm(hole.clear_mm - hole.r_mm) +
           " ;2ND SET-UP CLEARANCE ~\n  Q211=" + decimal_text(hole.dwell_s, 3) +
           " ;DWELL TIME AT DEPTH";
  }

  std::string feed_text(double per_min) {
    std::string written = significant_text(per_min, rules().feed_digits);
    if (written == feed_) return "";
    feed_ = std::move(written);
    return " F" + feed_;
  }

  void dwell(double seconds) override {
    block("CYCL DEF 9.0 DWELL TIME");
    block("CYCL DEF 9.1 DWELL " + decimal_text(seconds, 3));
  }

  void say(const MachineRemark& said) override {
    using Kind = MachineRemark::Kind;
    if (said.rpm > 0 && said.rpm != rpm_) {
      rpm_ = said.rpm;
      block("TOOL CALL" + speed_word());
      if (turning_ == said.kind) return;
    }
    if (starts_spindle(said)) turning_ = said.kind;
    if (said.kind == Kind::kSpindleStop) turning_.reset();
    switch (said.kind) {
      case Kind::kSpindleClockwise:
        return block("M3");
      case Kind::kSpindleCounterClockwise:
        return block("M4");
      case Kind::kSpindleStop:
        return block("M5");
      case Kind::kMist:
      case Kind::kFlood:
        return block("M8");
      case Kind::kCoolantOff:
        return block("M9");
      case Kind::kStop:
        return block("M0");
      case Kind::kOptionalStop:
        return block("M1");
      case Kind::kComment:
        comment(said.text);
    }
  }

  void end() override {
    block("M30");
    block("END PGM " + name_ + " MM");
  }

  std::string speed_word() const { return " S" + significant_text(rpm_, kFeedDigits); }

  static std::string signed_word(char letter, double value, int decimals) {
    const std::string text = decimal_text(value, decimals);
    return std::string(" ") + letter + (text.front() == '-' ? "" : "+") + text;
  }
  std::string word(char letter, double value) const {
    return signed_word(letter, value, rules().tip_decimals);
  }
  std::string point(const Vec3& p) const {
    return word('X', p.x) + word('Y', p.y) + word('Z', p.z);
  }
  std::string rotary_words(const RotaryAngles& angles) const {
    const bool ac = kind() == MachineKinematics::kXyzacTrt;
    return signed_word(ac ? 'A' : 'B', ac ? angles.a : angles.b, rules().angle_decimals) +
           signed_word('C', angles.c, rules().angle_decimals);
  }

  const std::string name_;
  std::size_t blocks_ = 0;
  bool tcp_on_ = false;
  double rpm_ = 0;
  std::optional<MachineRemark::Kind> turning_;  ///< direction of the spindle
  std::string feed_;
  std::string cycle_;  ///< that M99 calls
};

}  // namespace

std::unique_ptr<ProgramWriter> make_klartext_post(const Scene& scene, std::ostream& out) {
  return std::make_unique<KlartextWriter>(scene, out);
}

}  // namespace kerf
