#include "server/formats/gcode/machine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/formats/gcode/expression.h"
#include "server/formats/gcode/fault.h"

namespace kerf {
namespace {

constexpr double kMmPerInch = 25.4;
// Numbered parameters of LinuxCNC that mirror the offsets and the position.
constexpr int kG92Parameter = 5211;
constexpr int kSystemParameter = 5220;
constexpr int kPositionParameter = 5420;
constexpr int kSystemStride = 20;

int whole(double value, int least, int most, const GcodeWord& word) {
  if (!is_gcode_integer(value) || std::lround(value) < least || std::lround(value) > most)
    throw GcodeFault{word.text, "must be a whole number from " + std::to_string(least) + " to " +
                                    std::to_string(most)};
  return static_cast<int>(std::lround(value));
}

}  // namespace

GcodeMachine::GcodeMachine(const Scene& scene, GcodeParameters& parameters, MotionSink& sink,
                           Warn warn)
    : scene_(scene), parameters_(parameters), sink_(sink), warn_(std::move(warn)) {
  publish_position();
}

void GcodeMachine::check(const MotionSink::Result& result) {
  if (!result) throw GcodeFault{"", result.error()};
}

bool GcodeMachine::execute(GcodeBlock& block, std::size_t line) {
  line_ = line;
  refuse_foreign_axes(block);
  set_feed(block);
  change_tool(block);
  if (const GcodeCode* tcp = block.code(GcodeGroup::kTcp))
    set_tcp(tcp_by_length_code_, tcp->code == 428);
  const GcodeCode* special = block.code(GcodeGroup::kNonModal);
  if (special != nullptr && special->code == 40) {
    const auto seconds = block.take('p');
    if (!seconds || *seconds < 0)
      throw GcodeFault{special->text, "needs P with the seconds to wait"};
    check(sink_.dwell(*seconds, line_));
  }
  set_modes(block);
  set_offsets(block);
  move(block);
  for (const GcodeWord& word : block.words)
    if (!word.used) throw GcodeFault{word.text, "has no meaning in this block"};
  publish_position();
  const GcodeCode* stop = block.code(GcodeGroup::kStop);
  return stop != nullptr && (stop->code == 2 || stop->code == 30);
}

void GcodeMachine::refuse_foreign_axes(const GcodeBlock& block) const {
  const MachineKinematics kind = scene_.machine.kinematics;
  const std::string_view rotary = kind == MachineKinematics::kXyzacTrt   ? "ac"
                                  : kind == MachineKinematics::kXyzbcTrt ? "bc"
                                                                         : "";
  for (const char letter : {'a', 'b', 'c'}) {
    const GcodeWord* word = block.find(letter);
    if (word != nullptr && rotary.find(letter) == std::string_view::npos)
      throw GcodeFault{word->text, std::string("the machine ") + to_string(kind) + " has no " +
                                       word->text.front() + " axis"};
  }
}

void GcodeMachine::set_feed(GcodeBlock& block) {
  if (const GcodeCode* units = block.code(GcodeGroup::kUnits))
    unit_mm_ = units->code == 200 ? kMmPerInch : 1;
  if (const GcodeCode* code = block.code(GcodeGroup::kFeedMode)) {
    const FeedMode mode = code->code == 930   ? FeedMode::kInverseTime
                          : code->code == 940 ? FeedMode::kPerMinute
                                              : FeedMode::kPerRevolution;
    // A feed of one mode means nothing in another: it must be given anew.
    if (mode != feed_mode_) feed_ = feed_mm_ = 0;
    feed_mode_ = mode;
  }
  if (const auto feed = block.take('f')) {
    if (*feed < 0) throw GcodeFault{block.find('f')->text, "a feed cannot be negative"};
    feed_ = *feed;
    feed_mm_ = *feed * unit_mm_;
  }
  if (const auto speed = block.take('s')) {
    if (*speed < 0) throw GcodeFault{block.find('s')->text, "a spindle speed cannot be negative"};
    spindle_rpm_ = *speed;
  }
}

void GcodeMachine::change_tool(GcodeBlock& block) {
  if (const auto number = block.take('t')) {
    const GcodeWord& word = *block.find('t');
    const auto id = static_cast<ToolId>(whole(*number, 0, 1'000'000'000, word));
    if (id != 0 && !scene_.tools.contains(id))
      throw GcodeFault{word.text, "the scene has no tool " + std::to_string(id)};
    selected_ = id;
  }
  const GcodeCode* change = block.code(GcodeGroup::kToolChange);
  if (change == nullptr) return;
  if (!selected_) throw GcodeFault{change->text, "no tool was selected with T"};
  changed_tool_ = true;
  sink_.set_tool(*selected_ == 0 ? std::nullopt : selected_);
  if (*selected_ == 0) sink_.lift();
}

void GcodeMachine::set_tcp(bool by_length_code, bool by_m_code) {
  // The machine does not move: the same place gets other coordinates.
  const Vec3 tip = pose(at_).tip_mm;
  tcp_by_length_code_ = by_length_code;
  tcp_by_m_code_ = by_m_code;
  at_.xyz = programmed_from_tip(scene_.machine.kinematics, tool_center_point(), tip, at_.angles);
}

void GcodeMachine::set_tool_length(GcodeBlock& block, int code) {
  set_tcp(code == 434, tcp_by_m_code_);
  if (code == 490) return;
  const auto number = block.take('h');
  if (!number) return;
  const GcodeWord& word = *block.find('h');
  const auto id = static_cast<ToolId>(whole(*number, 0, 1'000'000'000, word));
  if (id != 0 && sink_.tool() && *sink_.tool() != id)
    warn_(word.text +
          " is the length of another tool than the loaded one; Kerf programs the tip, so lengths "
          "are not applied");
}

void GcodeMachine::set_modes(GcodeBlock& block) {
  if (const GcodeCode* code = block.code(GcodeGroup::kPlane))
    plane_ = code->code == 170 ? ArcPlane::kXy : code->code == 180 ? ArcPlane::kZx : ArcPlane::kYz;
  if (const GcodeCode* code = block.code(GcodeGroup::kToolLength))
    set_tool_length(block, code->code);
  if (const GcodeCode* code = block.code(GcodeGroup::kCoordinateSystem))
    coordinate_system_ = code->code <= 590 ? code->code / 10 - 53 : code->code - 584;
  if (const GcodeCode* code = block.code(GcodeGroup::kPathControl)) {
    // How tightly corners are followed is the controller's matter: Kerf follows the programmed
    // path.
    if (code->code == 640 && block.take('p')) block.take('q');
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kDistance)) incremental_ = code->code == 910;
  if (const GcodeCode* code = block.code(GcodeGroup::kArcDistance))
    arc_absolute_ = code->code == 901;
}

GcodeMachine::Offset GcodeMachine::offset() const {
  Offset sum = systems_[static_cast<std::size_t>(coordinate_system_)];
  if (g92_on_)
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += g92_[i];
  return sum;
}

double GcodeMachine::current(int axis) const {
  switch (axis) {
    case 0:
      return at_.xyz.x;
    case 1:
      return at_.xyz.y;
    case 2:
      return at_.xyz.z;
    case 3:
      return at_.angles.a;
    case 4:
      return at_.angles.b;
    default:
      return at_.angles.c;
  }
}

void GcodeMachine::set_offsets(GcodeBlock& block) {
  const GcodeCode* code = block.code(GcodeGroup::kNonModal);
  if (code == nullptr || code->code == 40 || code->code == 530) return;
  if (takes_axis_words(code->code) && block.code(GcodeGroup::kMotion) != nullptr &&
      block.has_any(kAxisLetters))
    throw GcodeFault{code->text, "may not share its axis words with a motion code in one block"};
  if (code->code == 280 || code->code == 300) return go_home(block);
  shift_origin(block, code->code);
}

void GcodeMachine::shift_origin(GcodeBlock& block, int code) {
  if (code >= 921) {
    g92_on_ = code == 923;
    if (code == 921) g92_ = {};
    return;
  }
  Offset* target = &g92_;
  bool to_current = true;
  if (code == 100) {
    const auto kind = block.take('l');
    const auto system = block.take('p');
    if (!kind || (*kind != 2 && *kind != 20))
      throw GcodeFault{"G10", "only L2 and L20 are supported"};
    if (!system) throw GcodeFault{"G10", "needs P with the number of the coordinate system"};
    const int number = whole(*system, 0, 9, *block.find('p'));
    target = &systems_[static_cast<std::size_t>(number == 0 ? coordinate_system_ : number)];
    to_current = *kind == 20;
  } else if (!block.has_any(kAxisLetters)) {
    throw GcodeFault{"G92", "needs at least one axis word"};
  }
  for (int axis = 0; axis < 6; ++axis) {
    const auto value = block.take(kAxisLetters[static_cast<std::size_t>(axis)]);
    if (!value) continue;
    const auto i = static_cast<std::size_t>(axis);
    const double wanted = *value * (axis < 3 ? unit_mm_ : 1);
    const double others = code == 920 ? systems_[static_cast<std::size_t>(coordinate_system_)][i]
                          : g92_on_   ? g92_[i]
                                      : 0;
    (*target)[i] = to_current ? current(axis) - wanted - others : wanted;
  }
  if (code == 920) {
    // Axes that are not named keep the shift that is in force.
    for (std::size_t i = 0; i < 6; ++i)
      if (!g92_on_ && block.find(kAxisLetters[i]) == nullptr) g92_[i] = 0;
    g92_on_ = true;
  }
}

void GcodeMachine::go_home(GcodeBlock& block) {
  const bool named = block.has_any(kAxisLetters);
  const std::array<bool, 3> linear{block.find('x') != nullptr, block.find('y') != nullptr,
                                   block.find('z') != nullptr};
  if (named) {
    const Position via = read_target(block);
    if (!approach(via, true, true)) straight(via, 0, true);
    at_ = via;
  }
  // Home is a place of the machine, which the workpiece does not know: the tool is away until it is
  // placed again.
  sink_.lift();
  for (std::size_t i = 0; i < 3; ++i)
    if (linear[i] || !named) known_[i] = false;
}

void GcodeMachine::publish_position() {
  const Offset sum = offset();
  for (int axis = 0; axis < 6; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const double unit = axis < 3 ? unit_mm_ : 1;
    parameters_.set(kPositionParameter + axis, (current(axis) - sum[i]) / unit);
    parameters_.set(kG92Parameter + axis, g92_[i] / unit);
    for (int system = 1; system <= 9; ++system)
      parameters_.set(kSystemParameter + 1 + kSystemStride * (system - 1) + axis,
                      systems_[static_cast<std::size_t>(system)][i] / unit);
  }
  parameters_.set(kSystemParameter, coordinate_system_);
}

double GcodeMachine::tool_length_mm() const {
  const auto tool = sink_.tool();
  return tool ? scene_.tools.at(*tool).tool.length_mm : 0;
}

ToolPose GcodeMachine::pose(const Position& position) const {
  const MachineKinematics kind = scene_.machine.kinematics;
  return {
      tip_from_programmed(kind, tool_center_point(), position.xyz, position.angles),
      kind == MachineKinematics::kToolVector ? position.axis : table_axis(kind, position.angles)};
}

}  // namespace kerf
