// SPDX-License-Identifier: Apache-2.0
#include "web/wasm/files/program_block.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "kernel/cut/workers.h"
#include "kernel/dexel/stock_column.h"
#include "server/formats/derived_json.h"
#include "server/formats/text_file.h"
#include "server/verify/wall_check.h"

namespace kerf::page {
namespace {

using Result = std::expected<void, std::string>;

/// States that are kept over the whole program, and the fewest motions between two of them.
constexpr std::size_t kKeptStates = 64, kBetweenMin = 64;
/// Of a model without a program: the share of its size that is accurate enough, and its limits, mm.
constexpr double kTargetShare = 1e-3, kTargetMinMm = 0.02, kTargetMaxMm = 1;

GcodeEnvironment environment() {
  GcodeEnvironment found;
  found.subroutine_folders = {"."};
  return found;
}

/// Returns a scene for a model that no program carves: any tool will do.
std::string scene_of_stock(const std::string& file) {
  return nlohmann::json{
      {"name", std::filesystem::path(file).stem().string()},
      {"stock", {{"shape", "mesh"}, {"file", file}}},
      {"accuracy", {{"pitch_mm", kTargetMaxMm}, {"tolerance_mm", kTargetMaxMm}}},
      {"tools", {{{"id", 1}, {"shape", "flat"}, {"diameter_mm", 6}, {"length_mm", 30}}}}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

std::expected<ProgramBlock, std::string> ProgramBlock::read(const BlockFiles& files) {
  ProgramBlock block;
  if (auto done = block.read_scene(files); !done) return std::unexpected(done.error());
  if (auto done = block.read_program(files); !done) return std::unexpected(done.error());
  return block;
}

Result ProgramBlock::read_scene(const BlockFiles& files) {
  label_ = files.scene.empty() ? files.program : files.scene;
  if (!files.scene.empty()) {
    auto scene = load_scene(files.scene);
    if (!scene) return std::unexpected(to_string(scene.error()));
    scene_ = *std::move(scene);
    if (scene_.stock_repair != MeshRepair{})
      note(scene_.stock_file.file + ": " + to_string(scene_.stock_repair));
  } else if (!files.program.empty()) {
    const auto text = read_file(files.program);
    if (!text) return std::unexpected(files.program + ": cannot be read");
    SceneWishes wishes;
    wishes.stock_file = files.stock;
    auto derived = derive_scene(files.program, *text, environment(), wishes);
    if (!derived) return std::unexpected(derived.error());
    derived_ = derived_json(*derived);
    scene_ = std::move(derived->scene);
    notes_ = std::move(derived->notes);
  } else {
    label_ = files.stock;
    auto scene =
        parse_scene(scene_of_stock(files.stock),
                    {.name = files.stock, .base_folder = ".", .files = {}, .load_mesh = load_mesh});
    if (!scene) return std::unexpected(to_string(scene.error()));
    scene_ = *std::move(scene);
    const BoxStock box = stock_bounds(scene_.settings.stock);
    const Vec3 size = box.max_mm - box.min_mm;
    const double target =
        std::clamp(kTargetShare * std::max({size.x, size.y, size.z}), kTargetMinMm, kTargetMaxMm);
    if (!resolve_accuracy(scene_, {.target_mm = target})) scene_.settings.pitch_mm = target;
  }
  return settle();
}

// As for kerf-carve without options.
Result ProgramBlock::settle() {
  if (scene_.accuracy) {
    const auto settled = resolve_accuracy(scene_, scene_.accuracy->request);
    if (!settled)
      return std::unexpected(label_ + ": accuracy." + settled.error().field + " " +
                             settled.error().reason);
  }
  const auto resolved = resolve_chords(scene_);
  if (!resolved)
    return std::unexpected(label_ + ": tool " + std::to_string(resolved.error().tool) + ": " +
                           resolved.error().error.field + " " + resolved.error().error.reason);
  scene_.settings.keep_normals = true;
  return {};
}

Result ProgramBlock::read_program(const BlockFiles& files) {
  if (files.program.empty()) return {};
  const auto text = read_file(files.program);
  if (!text) return std::unexpected(files.program + ": cannot be read");
  auto program = parse_program(files.program, *text, scene_, environment());
  if (!program) return std::unexpected(to_string(program.error()));
  program_ = *std::move(program);
  return {};
}

// A pitch that is only implied by a target must not lose what is thinner.
void ProgramBlock::refine_for_walls() {
  if (!scene_.accuracy) return;
  const std::size_t samples = wall_samples(scene_, program_);
  if (samples == 0 || (program_.motions.empty() && !scene_.settings.stock_mesh)) return;
  const WallCheck walls(scene_, program_, samples);
  if (const auto settled = walls.refine(scene_); !settled) note(label_ + ": " + settled.error());
}

Result ProgramBlock::make() {
  refine_for_walls();
  if (scene_.accuracy) note("accuracy: " + scene_.accuracy->reason);
  auto sculpture = Sculpture::create(scene_.settings);
  if (!sculpture) return std::unexpected(label_ + ": " + sculpture.error().reason);
  sculpture_.emplace(*std::move(sculpture));
  for (const auto& [id, tool] : scene_.tools)
    if (auto defined = sculpture_->apply(DefineTool{id, tool.tool}); !defined)
      return std::unexpected(label_ + ": tool " + std::to_string(id) + ": " +
                             defined.error().reason);
  mark_all(sculpture_->grid());
  return {};
}

void ProgramBlock::keep_state() {
  if (!kept_.empty() && kept_.back().carved >= carved_) return;
  kept_.push_back({sculpture_->state(), carved_, machining_s_, {}});
}

Result ProgramBlock::carve(std::size_t motions, bool /*feels*/) {
  const std::size_t between = std::max(kBetweenMin, program_.motions.size() / kKeptStates);
  const std::size_t end = std::min(program_.motions.size(), carved_ + motions);
  while (carved_ < end) {
    if (carved_ % between == 0) keep_state();
    const ProgramMotion& motion = program_.motions[carved_];
    const auto result = sculpture_->apply(MoveTool{.tool = motion.tool,
                                                   .from = motion.from,
                                                   .to = motion.to,
                                                   .duration_s = motion.duration_s,
                                                   .feel = false});
    if (!result)
      return std::unexpected(place_of(program_, motion.file, motion.line) + ": " +
                             result.error().reason);
    const auto& tiles = result->changed_tiles;
    // Of the last state before this motion: after seek() others may be kept behind it.
    auto state = std::ranges::upper_bound(kept_, carved_, {}, &Kept::carved);
    std::prev(state)->changed.insert(tiles.begin(), tiles.end());
    mark(tiles);
    machining_s_ += motion.duration_s;
    ++carved_;
  }
  return {};
}

std::optional<double> ProgramBlock::next_s() const {
  if (carved_ == program_.motions.size()) return std::nullopt;
  return machining_s_ + program_.motions[carved_].duration_s;
}

Result ProgramBlock::seek(std::size_t motion) {
  if (kept_.empty()) return {};  // nothing is carved
  const auto to = std::prev(std::ranges::upper_bound(kept_, motion, {}, &Kept::carved));
  if (motion >= carved_ && to->carved <= carved_) return {};  // carving on is as good
  const auto [from, until] = std::minmax(to->carved, carved_);
  auto between = std::prev(std::ranges::upper_bound(kept_, from, {}, &Kept::carved));
  for (; between != kept_.end() && between->carved < until; ++between) mark(between->changed);
  sculpture_->restore(to->state);
  carved_ = to->carved;
  machining_s_ = to->machining_s;
  return {};
}

}  // namespace kerf::page
