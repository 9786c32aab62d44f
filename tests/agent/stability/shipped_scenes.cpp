// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/stability/shipped_scenes.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "haptic_agent/demo/carving.h"
#include "haptic_agent/device/carving_figure.h"
#include "haptic_agent/device/path_cursor.h"
#include "haptic_agent/device/reference/reference_protocol.h"
#include "kernel/dexel/stock_column.h"
#include "server/formats/scene.h"
#include "server/formats/scene_templates.h"
#include "tests/agent/stability/test_bed.h"

namespace kerf::agent {
namespace {

/// Time at rest before the path, in which the device arms, and time on the path until the ramp is
/// over.
constexpr double kRestS = 0.9;
constexpr double kRampS = 0.8;

/// The reference device on a path.
class PlayedDevice final : public HapticDevice {
 public:
  explicit PlayedDevice(PathCursor path) : path_(std::move(path)) {}
  DeviceCapabilities capabilities() const override {
    DeviceCapabilities device = reference::pen_capabilities({});
    device.workspace_min_mm = device.workspace_max_mm = {};  // the block may be larger
    return device;
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    if (start_us_ == 0) start_us_ = now_us;
    const double time_s = static_cast<double>(now_us - start_us_) * 1e-6;
    const PathPoint at = path_.at(std::max(0.0, time_s - kRestS));
    finished = at.at_end;
    return {.tip_mm = at.tip_mm,
            .axis = at.axis,
            .buttons = wire::kButtonDeadman | (at.cutting ? wire::kButtonCutting : 0U),
            .tool_id = at.tool_id,
            .time_us = now_us,
            .valid = true,
            .phase = DevicePhase::kReady};
  }
  void write(const Wrench& wrench) noexcept override { output = wrench; }
  void stop() noexcept override { output = {}; }

  Wrench output;
  bool finished = false;

 private:
  PathCursor path_;
  std::uint64_t start_us_ = 0;
};

std::string content(const std::string& file) {
  constexpr std::string_view kTemplate = "template:";
  for (const SceneTemplate& one : scene_templates()) {
    if (file == std::string(kTemplate) + std::string(one.id)) return std::string(one.scene);
  }
  std::ifstream in(std::string(KERF_SOURCE_DIR "/") + file, std::ios::binary);
  if (!in) throw std::runtime_error(file + " cannot be read");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

PoseScript path_of(const ShippedScene& scene, const std::string& text) {
  if (scene.program > 0) {
    static const demo::Carving kCarving = demo::carve(demo::Ammonite{});
    const auto& strokes = scene.program == 1 ? kCarving.first : kCarving.second;
    auto script = parse_apt_script("demo.apt", demo::apt_text("DEMO", strokes, demo::kRetractMm));
    if (!script) throw std::runtime_error(to_string(script.error()));
    return *std::move(script);
  }
  const auto read = parse_scene(text, {.name = scene.file, .base_folder = {}});
  if (!read) throw std::runtime_error(to_string(read.error()));
  const BoxStock box = stock_bounds(read->settings.stock);
  return make_carving_figure({box.min_mm, box.max_mm}, 1);
}

}  // namespace

const std::vector<ShippedScene>& shipped_scenes() {
  static const std::vector<ShippedScene> kScenes = {{"haptic_agent/demo/demo.json", 1},
                                                    {"haptic_agent/demo/demo.json", 2},
                                                    {"haptic_agent/demo/demo.json", 0},
                                                    {"tests/formats/scenes/boat.json", 0},
                                                    {"tests/formats/scenes/chips.json", 0},
                                                    {"tests/formats/scenes/impeller.json", 0},
                                                    {"tests/formats/scenes/standard.json", 0},
                                                    {"tests/package/pocket.json", 0},
                                                    {"template:box", 0},
                                                    {"template:cylinder", 0},
                                                    {"template:milling", 0},
                                                    {"template:five-axis", 0},
                                                    {"template:ammonite", 0}};
  return kScenes;
}

ShippedFeel feel_shipped(const ShippedScene& scene, double seconds) {
  const std::string text = content(scene.file);
  PlayedDevice device(PathCursor(path_of(scene, text), false));
  PlayedDevice same = device;
  TestBed bed(text, device, {}, {}, true);
  // Without a replica each sample is sent alone, so each answer of the server is for one sample.
  TestBed each(text, same, {}, {}, false);
  ShippedFeel feel;
  const int ticks = static_cast<int>((kRestS + seconds) * 1000);
  const int first = static_cast<int>((kRestS + kRampS) * 1000);
  Wrench before;
  for (int i = 0; i < ticks && !device.finished; ++i) {
    bed.tick();
    each.tick();
    const Vec3 force(each.newest().force_n), torque(each.newest().torque_nmm);
    const Wrench late = std::exchange(before, {force, torque});
    if (i < first || !(dot(force, force) > 0)) continue;
    feel.server_force.add(device.output.force_n, force);
    feel.server_torque.add(device.output.torque_nmm, torque);
    feel.late_force.add(late.force_n, force);
    feel.late_torque.add(late.torque_nmm, torque);
  }
  feel.agent = bed.servo().report().felt;
  feel.trips = bed.servo().supervisor().trips();
  return feel;
}

}  // namespace kerf::agent
