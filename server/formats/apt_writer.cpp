// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <ostream>

#include "server/formats/machine_kinematics.h"
#include "server/formats/number_text.h"
#include "server/formats/pose_grid.h"
#include "server/formats/program_writing.h"
#include "server/formats/tool_text.h"

namespace kerf {
namespace {

std::string pose_text(const ToolPose& pose) {
  std::string text = exact_text(pose.tip_mm.x);
  for (const double value : {pose.tip_mm.y, pose.tip_mm.z, pose.axis.x, pose.axis.y, pose.axis.z}) {
    text += ',';
    text += exact_text(value);
  }
  return text;
}

class AptWriter final : public ProgramWriter {
 public:
  AptWriter(const Scene& scene, std::ostream& out) : scene_(scene), out_(out) {}

  void note(const std::string& line) override { notes_ += "$$ " + printable(line) + '\n'; }

  WriteResult add(const ProgramMotion& motion) override {
    if (!started_) header();
    const ToolPose from = admit_pose(motion.from);
    const ToolPose to = admit_pose(motion.to);
    const double duration_s = std::max(motion.duration_s, kWrittenDurationMinS);
    if (!placed_ || motion.tool != tool_) out_ << "LOADTL/" << motion.tool << '\n';
    if (!placed_ || motion.tool != tool_ || !(from == last_))
      out_ << "FROM/" << pose_text(from) << '\n';
    placed_ = true;
    tool_ = motion.tool;
    if (from == to) {
      out_ << "DELAY/" << exact_text(duration_s) << '\n';
    } else {
      if (motion.rapid) {
        out_ << "RAPID\n";
      } else {
        feed(from, to, duration_s);
      }
      out_ << "GOTO/" << pose_text(to) << '\n';
    }
    last_ = to;
    return write_result(out_);
  }

  WriteResult remark(const MachineRemark& said) override {
    if (!started_) header();
    using Kind = MachineRemark::Kind;
    const std::string speed =
        said.rpm > 0 ? significant_text(said.rpm, kFeedDigits) + ",RPM," : std::string();
    switch (said.kind) {
      case Kind::kSpindleClockwise:
        out_ << "SPINDL/" << speed << (said.rpm > 0 ? "CLW\n" : "ON\n");
        break;
      case Kind::kSpindleCounterClockwise:
        out_ << "SPINDL/" << speed << "CCLW\n";
        break;
      case Kind::kSpindleStop:
        out_ << "SPINDL/OFF\n";
        break;
      case Kind::kMist:
        out_ << "COOLNT/MIST\n";
        break;
      case Kind::kFlood:
        out_ << "COOLNT/FLOOD\n";
        break;
      case Kind::kCoolantOff:
        out_ << "COOLNT/OFF\n";
        break;
      case Kind::kStop:
        out_ << "STOP\n";
        break;
      case Kind::kOptionalStop:
        out_ << "OPSTOP\n";
        break;
      case Kind::kComment:
        out_ << "PPRINT/" << printable(said.text) << '\n';
    }
    return write_result(out_);
  }

  WriteResult finish() override {
    if (!started_) header();
    out_ << "FINI\n";
    out_.flush();
    return write_result(out_);
  }

 private:
  void header() {
    started_ = true;
    out_ << "PARTNO/" << printable(scene_.name) << "\n$$ written by Kerf; coordinates are those of "
         << "the tool tip\n";
    for (const auto& [id, tool] : scene_.tools)
      for (const std::string& text : tool_comments(id, tool.shape)) out_ << "$$ " << text << '\n';
    out_ << "$$ poses read back bit-identical; durations are exact to 1e-6 relative\n"
         << "$$ FROM within the program places the tool without cutting\n"
         << notes_ << "UNITS/MM\nMULTAX/ON\n";
  }

  void feed(const ToolPose& from, const ToolPose& to, double duration_s) {
    std::string feed =
        significant_text(60 * feed_travel(from, to).length() / duration_s, kFeedDigits);
    if (feed == feed_) return;
    feed_ = std::move(feed);
    out_ << "FEDRAT/" << feed_ << ",MMPM\n";
  }

  const Scene& scene_;
  std::ostream& out_;
  bool started_ = false, placed_ = false;
  ToolId tool_ = 0;
  ToolPose last_;
  std::string feed_, notes_;
};

}  // namespace

std::unique_ptr<ProgramWriter> make_apt_writer(const Scene& scene, std::ostream& out) {
  return std::make_unique<AptWriter>(scene, out);
}

}  // namespace kerf
