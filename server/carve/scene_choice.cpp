// SPDX-License-Identifier: Apache-2.0
#include "server/carve/scene_choice.h"

#include <algorithm>
#include <utility>

#include "kernel/force/milling_presets.h"
#include "server/carve/environment_files.h"
#include "server/formats/derived_json.h"
#include "server/formats/text_file.h"
#include "server/formats/unit_question.h"

namespace kerf {
namespace {

using Result = std::expected<void, Failure>;

/// Tolerance of a derived scene whose pitch is given, as a share of it.
constexpr double kToleranceShare = 0.1;
/// Tolerance of a verified block, as a share of the part's.
constexpr double kCarvedShare = 0.25;

Result settle_tools(const CarveOptions& options, Scene& scene) {
  const auto resolved = resolve_chords(scene);
  if (resolved) return {};
  return bad_input(scene_label(options) + ": tool " + std::to_string(resolved.error().tool) + ": " +
                   resolved.error().error.field + " " + resolved.error().error.reason);
}

// The command line overrides the scene. With a target, the other values are chosen to meet it.
Result settle_options(const CarveOptions& options, ChosenScene& chosen) {
  Scene& scene = chosen.scene;
  AccuracyRequest request;
  if (scene.accuracy) request = scene.accuracy->request;
  if (options.pitch_mm) request.pitch_mm = options.pitch_mm;
  if (options.verify) {
    // Chords of arcs must not count as deviations.
    request.tolerance_mm =
        std::min(scene.settings.tolerance_mm, kCarvedShare * part_tolerance_mm(options));
  } else if (options.tolerance_mm) {
    request.tolerance_mm = options.tolerance_mm;
  }
  if (options.rays) request.rays = *options.rays == "tri-dexel" ? Rays::kTriDexel : Rays::kDexel;
  if (options.motion)
    request.motion = *options.motion == "paper" ? MotionModel::kPaper : MotionModel::kTight;
  if (scene.accuracy) {
    const auto settled = resolve_accuracy(scene, request);
    if (!settled)
      return bad_input(scene_label(options) + ": accuracy." + settled.error().field + " " +
                       settled.error().reason);
    chosen.notes.push_back("accuracy: " + scene.accuracy->reason);
    return settle_tools(options, scene);
  }
  SculptureSettings& settings = scene.settings;
  settings.pitch_mm = request.pitch_mm.value_or(settings.pitch_mm);
  settings.tolerance_mm = request.tolerance_mm.value_or(settings.tolerance_mm);
  settings.rays = request.rays.value_or(settings.rays);
  settings.motion = request.motion.value_or(settings.motion);
  return settle_tools(options, scene);
}

// The coefficients of a mechanistic law are those of a material, or of the scene.
Result settle_law(const CarveOptions& options, ForceSettings& force) {
  const bool stated = force.law == ForceLaw::kMechanistic;
  for (const ForceLaw law :
       {ForceLaw::kDexelRemovalRate, ForceLaw::kSpecificEnergy, ForceLaw::kMechanistic})
    if (options.law && *options.law == to_string(law)) force.law = law;
  if (force.law != ForceLaw::kMechanistic) {
    if (options.material) return bad_input("--material needs --law mechanistic");
    return {};
  }
  if (!options.material)
    return stated ? Result{} : bad_input("--law mechanistic needs --material, or a scene with it");
  for (const MillingPreset& preset : milling_presets()) {
    if (*options.material != preset.material) continue;
    force.milling.cut_n_per_mm2 = preset.cut_n_per_mm2;
    force.milling.edge_n_per_mm = preset.edge_n_per_mm;
    force.milling.chip_exponents = in_all_directions(preset.chip_exponent);
  }
  return {};
}

std::expected<DerivedScene, Failure> derive(const CarveOptions& options,
                                            const std::optional<BoxStock>& part_mm) {
  const std::string name = options.program.string();
  const auto text = read_file(options.program);
  if (!text) return bad_input(name + ": cannot be read");
  const auto environment = load_environment(options.environment, options.program);
  if (!environment) return bad_input(environment.error());
  SceneWishes wishes = options.wishes;
  wishes.part_mm = part_mm;
  auto derived = derive_scene(name, *text, *environment, wishes);
  if (!derived) return bad_input(derived.error());
  return *std::move(derived);
}

std::expected<ChosenScene, Failure> derived(const CarveOptions& options,
                                            const std::optional<BoxStock>& part_mm) {
  auto derived = derive(options, part_mm);
  if (!derived) return std::unexpected(derived.error());
  for (std::string& note : derived->notes) note.insert(0, "scene: ");
  // A requested pitch is kept, because the target was only assumed.
  if (options.pitch_mm) {
    derived->scene.accuracy.reset();
    derived->scene.settings.tolerance_mm = kToleranceShare * *options.pitch_mm;
  }
  return ChosenScene{std::move(derived->scene), std::move(derived->notes),
                     std::move(derived->origins)};
}

std::expected<ChosenScene, Failure> loaded(const CarveOptions& options) {
  auto scene = load_scene(options.scene);
  if (!scene) return bad_input(to_string(scene.error()));
  ChosenScene chosen{*std::move(scene), {}, {}};
  if (chosen.scene.stock_repair != MeshRepair{})
    chosen.notes.push_back("scene: " + chosen.scene.stock_file.file + ": " +
                           to_string(chosen.scene.stock_repair));
  return chosen;
}

// Rewrites the name of a file from relative to `from` to relative to `to`.
void rebase_file(std::string& file, const std::filesystem::path& from,
                 const std::filesystem::path& to) {
  if (file.empty() || std::filesystem::path(file).is_absolute()) return;
  file = std::filesystem::proximate(std::filesystem::absolute(from / file), to).string();
}

}  // namespace

std::string scene_label(const CarveOptions& options) {
  return options.scene.empty() ? options.program.string() : options.scene.string();
}

std::string scene_text(Scene scene, const CarveOptions& options,
                       const std::filesystem::path& target) {
  const std::filesystem::path from =
      options.scene.empty() ? options.wishes.folder : options.scene.parent_path();
  const std::filesystem::path to = std::filesystem::absolute(target).parent_path();
  rebase_file(scene.stock_file.file, from, to);
  for (MeshFile& mesh : scene.obstacle_files) rebase_file(mesh.file, from, to);
  for (Guide& guide : scene.guides)
    if (auto* path = std::get_if<PathGuide>(&guide.shape)) rebase_file(path->file, from, to);
  return scene_json(scene) + '\n';
}

std::expected<std::string, Failure> derived_text(const CarveOptions& options) {
  const auto made = derive(options, std::nullopt);
  if (!made) return std::unexpected(made.error());
  const auto questions = unit_questions(made->scene);
  return derived_json(*made, questions.empty() ? "" : questions_json(questions)) + '\n';
}

std::expected<std::string, Failure> explained_text(const std::filesystem::path& file) {
  const auto scene = load_scene(file);
  if (!scene) return bad_input(to_string(scene.error()));
  return explain_scene(*scene);
}

std::expected<ChosenScene, Failure> choose_scene(const CarveOptions& options,
                                                 const std::optional<BoxStock>& part_mm) {
  auto chosen = options.scene.empty() ? derived(options, part_mm) : loaded(options);
  if (!chosen) return chosen;
  for (const UnitQuestion& question : unit_questions(chosen->scene))
    chosen->notes.push_back("scene: " + question.text);
  SculptureSettings& settings = chosen->scene.settings;
  if (auto settled = settle_law(options, settings.force); !settled)
    return std::unexpected(settled.error());
  if (auto settled = settle_options(options, *chosen); !settled)
    return std::unexpected(settled.error());
  // Only meshing and pictures use normals.
  settings.keep_normals = !options.models.empty() || options.surface.reference || options.page;
  return chosen;
}

}  // namespace kerf
