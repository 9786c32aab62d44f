// SPDX-License-Identifier: Apache-2.0
#include "server/carve/carve.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <future>
#include <iostream>
#include <iterator>
#include <memory>
#include <stop_token>
#include <utility>
#include <vector>

#include "kernel/sculpture.h"
#include "server/carve/carve_report.h"
#include "server/carve/environment_files.h"
#include "server/carve/failure.h"
#include "server/carve/fit_pictures.h"
#include "server/carve/model_outputs.h"
#include "server/carve/output_file.h"
#include "server/carve/program_cutter.h"
#include "server/carve/progress.h"
#include "server/carve/scene_choice.h"
#include "server/carve/simulation_json.h"
#include "server/carve/stop_signal.h"
#include "server/carve/stopwatch.h"
#include "server/carve/verify_page.h"
#include "server/formats/forces_csv.h"
#include "server/formats/program.h"
#include "server/formats/program_writer.h"
#include "server/formats/scene.h"
#include "server/formats/text_file.h"
#include "server/threads/thread_pool.h"
#include "server/verify/wall_check.h"

namespace kerf {
namespace {

constexpr const char* kInterrupted = "interrupted";

class Carving {
 public:
  Carving(const CarveOptions& options, OutputFiles& outputs, std::stop_token stop)
      : options_(options), outputs_(outputs), stop_(std::move(stop)), pool_(options.threads) {}

  /// Returns the exit status.
  std::expected<int, Failure> run() {
    for (const auto step :
         {&Carving::read_scene, &Carving::read_program, &Carving::find_walls, &Carving::make_block,
          &Carving::cut, &Carving::check_walls, &Carving::write_models, &Carving::write_report}) {
      const auto done = (this->*step)();
      if (stop_.stop_requested())
        return std::unexpected(Failure{StopSignal::status(), kInterrupted});
      if (!done) return std::unexpected(done.error());
    }
    if (auto done = outputs_.commit(); !done) return bad_output(done.error());
    progress_.clear();
    for (const std::string& warning : report_.warnings) std::cerr << "warning: " << warning << '\n';
    if (!verdict_) return 0;
    std::cout << verdict_text(*verdict_) << std::flush;
    return verdict_->passes() ? 0 : kFailedVerification;
  }

 private:
  using Result = std::expected<void, Failure>;

  Result read_scene() {
    const auto say = [this](std::string text) { note(std::move(text)); };
    auto part = load_reference(options_.reference, options_.reference_as, say);
    if (!part) return bad_input(part.error());
    part_ = *std::move(part);
    auto chosen =
        choose_scene(options_, options_.verify ? std::optional(bounds_of(*part_)) : std::nullopt);
    if (!chosen) return std::unexpected(chosen.error());
    scene_ = std::move(chosen->scene);
    report_.origins = std::move(chosen->origins);
    std::ranges::for_each(chosen->notes, say);
    auto reference = load_reference(options_.surface.reference, options_.reference_as, say);
    if (!reference) return bad_input(reference.error());
    reference_ = *std::move(reference);
    ask_for_unit(options_.reference, options_.reference_as, part_, scene_, say);
    ask_for_unit(options_.surface.reference, options_.reference_as, reference_, scene_, say);
    report_.scene_file = options_.scene.string();
    return {};
  }

  void note(std::string text) {
    std::cerr << text << '\n';
    report_.notes.push_back(std::move(text));
  }

  Result make_block() {
    const SculptureSettings& settings = scene_.settings;
    progress_.show("preparing the stock", 0);
    auto sculpture = Sculpture::create(settings);
    if (!sculpture) return bad_input(scene_label(options_) + ": " + sculpture.error().reason);
    sculpture_ = std::make_unique<Sculpture>(*std::move(sculpture));
    for (const auto& [id, tool] : scene_.tools)
      if (auto defined = sculpture_->apply(DefineTool{id, tool.tool}); !defined)
        return bad_input(options_.scene.string() + ": tool " + std::to_string(id) + ": " +
                         defined.error().reason);
    report_.read_s += watch_.lap();
    return {};
  }

  // Samples the surface that the program leaves. A target that needs a finer pitch for thin walls
  // gets it, or a warning.
  Result find_walls() {
    const std::size_t samples = options_.wall_samples.value_or(wall_samples(scene_, program_));
    if (samples == 0 || (program_.motions.empty() && !scene_.settings.stock_mesh)) return {};
    progress_.show("looking for thin walls", 0);
    walls_.emplace(scene_, program_, samples, stop_);
    refine_for_walls();
    report_.walls_s = watch_.lap();
    return {};
  }

  void refine_for_walls() {
    if (!scene_.accuracy || stop_.stop_requested()) return;
    const double before_mm = scene_.settings.pitch_mm;
    const auto settled = walls_->refine(scene_, stop_);
    if (!settled) report_.warnings.push_back(scene_label(options_) + ": " + settled.error());
    if (scene_.settings.pitch_mm < before_mm) note("accuracy: " + scene_.accuracy->reason);
  }

  Result check_walls() {
    if (!walls_) return {};
    WallReport found = walls_->find(stop_);
    mark_missing(found.walls, sculpture_->snapshot());
    if (scene_.accuracy) found.target = walls_->target_at_walls(stop_);
    std::ranges::move(walls_->warnings(found), std::back_inserter(report_.warnings));
    report_.walls = walls_->json(found);
    report_.walls_s += watch_.lap();
    return {};
  }

  Result read_program() {
    const std::string name = options_.program.string();
    const auto text = read_file(options_.program);
    if (!text) return bad_input(name + ": cannot be read");
    const auto environment = load_environment(options_.environment, options_.program);
    if (!environment) return bad_input(environment.error());
    auto program = parse_program(name, *text, scene_, *environment);
    if (!program) return bad_input(to_string(program.error()));
    program_ = *std::move(program);
    if (options_.rate_hz) {
      const double samples = sample_count(program_, *options_.rate_hz);
      if (samples > kSamplesMax)
        return bad_input(name + ": needs " + std::to_string(samples) +
                         " motions at this --rate; the limit is " + std::to_string(kSamplesMax));
      program_ = sample_program(program_, *options_.rate_hz);
    }
    text_ = *text;
    report_.program_file = name;
    report_.program_lines = program_.lines;
    report_.read_as = program_.read_as;
    report_.warnings = program_.warnings;
    report_.read_s = watch_.lap();
    return {};
  }

  Result cut() {
    std::ofstream forces;
    if (options_.forces) {
      forces.open(output(*options_.forces).temporary(), std::ios::binary);
      write_forces_header(forces, options_.device_limits);
    }
    simulation_.emplace(scene_, program_, options_.report || options_.verify);
    // Of an assumed stock, only the material above the part is certain.
    std::optional<ConvexOutline> certain;
    if (options_.verify && scene_.stock_assumed) certain.emplace(*part_);
    ProgramCutter cutter(scene_, program_, *sculpture_, pool_, options_.forces.has_value(),
                         certain ? &*certain : nullptr);
    uncut_ = sculpture_->snapshot();
    progress_.show("carving", 0);
    const std::span<const ProgramMotion> all = program_.motions;
    while (report_.motions < all.size()) {
      if (stop_.stop_requested()) return {};
      const auto cuts = cutter.cut(all.subspan(report_.motions), stop_);
      if (!cuts) return bad_input(cuts.error());
      for (const auto& [result, depth_mm] : *cuts) {
        const ProgramMotion& motion = all[report_.motions++];
        report_.machining_s += motion.duration_s;
        simulation_->follow(motion, result, depth_mm);
        if (options_.forces) {
          write_forces_row(forces, report_.machining_s, motion.to, result, options_.device_limits);
        }
      }
      progress_.show("carving",
                     static_cast<double>(report_.motions) / static_cast<double>(all.size()));
    }
    if (options_.forces && !forces.flush())
      return bad_output(options_.forces->string() + ": cannot be written");
    report_.stock_volume_mm3 = sculpture_->stock_volume_mm3();
    report_.removed_volume_mm3 = sculpture_->removed_volume_mm3();
    report_.imprint_volume_mm3 = sculpture_->imprint_volume_mm3();
    report_.sub_motions = sculpture_->sub_motions();
    report_.stock_memory_bytes = sculpture_->memory_bytes();
    report_.state_hash = sculpture_->state_hash();
    report_.cut_s = watch_.lap();
    return simulate();
  }

  // NC verification: times, loads, collisions, gouges, rests.
  Result simulate() {
    const double tolerance_mm = options_.gouge_tolerance_mm.value_or(
        options_.verify ? part_tolerance_mm(options_) : scene_.settings.tolerance_mm);
    PartFit fit;
    if (part_) {
      const SearchControl control{
          [this](double share) { progress_.show("comparing with the part", share); }, stop_};
      auto found = fit_part(*uncut_, sculpture_->snapshot(), *part_, scene_, program_,
                            {tolerance_mm, options_.verify}, control);
      if (!found) return bad_input(options_.reference->string() + ": " + found.error());
      fit = *std::move(found);
    }
    warn_of_simulation(*simulation_, fit, report_.warnings);
    report_.simulation = simulation_json(*simulation_, options_.tool_change_s, fit);
    if (options_.verify && !stop_.stop_requested()) {
      verdict_ = make_verdict(scene_, *simulation_, fit, options_.reference->string(), tolerance_mm,
                              options_.tool_change_s);
      report_.verdict = verdict_json(*verdict_);
      warn_of_resolution(scene_, tolerance_mm, report_.warnings);
    }
    report_.simulate_s = watch_.lap();
    return {};
  }

  // Every file is a separate job. The bytes do not depend on whether they run concurrently.
  Result write_models() {
    if (auto made = make_surface(); !made) return made;
    std::vector<std::function<Result()>> jobs;
    jobs.reserve(options_.models.size());
    std::vector<WrittenModel> written(options_.models.size());
    // One line on a terminal cannot show several files at once.
    ModelProgress bar;
    if (options_.threads == 1 || options_.models.size() == 1)
      bar = [this](double share) { progress_.show("meshing", share); };
    for (std::size_t n = 0; n < options_.models.size(); ++n)
      jobs.push_back(model_job(options_.models[n], bar, written[n]));
    if (auto done = run_jobs(jobs); !done) return done;
    // Quantization may drop triangles. The finest file has all of them.
    add_written(written, report_.triangles, report_.warnings);
    report_.mesh_s = watch_.lap();
    jobs.clear();
    const double tolerance_mm = options_.nc_tolerance_mm.value_or(0);
    if (options_.ngc)
      jobs.push_back(
          program_job(*options_.ngc, {.post = options_.post, .tolerance_mm = tolerance_mm}));
    if (options_.apt)
      jobs.push_back(program_job(*options_.apt,
                                 {.format = ProgramFormat::kApt, .tolerance_mm = tolerance_mm}));
    auto done = run_jobs(jobs);
    report_.write_s = watch_.lap();
    return done;
  }

  // Simplifies and measures once for all files, and only if requested.
  Result make_surface() {
    const SurfaceRequest& request = options_.surface;
    if (options_.models.empty() && !request.reference) return {};
    const ModelProgress bar = [this](double share) { progress_.show("measuring", share); };
    bar(0);
    auto made = CarvedSurface::make(sculpture_->solid(), request,
                                    reference_ ? &*reference_ : nullptr, bar, stop_, pool_);
    if (!made) return bad_input(scene_label(options_) + ": " + made.error());
    surface_ = *std::move(made);
    report_.surface = surface_->report();
    return {};
  }

  std::function<Result()> model_job(const ModelChoice& choice, const ModelProgress& bar,
                                    WrittenModel& model) {
    return [this, choice, bar, &model, &file = output(choice.path)]() -> Result {
      auto written = surface_->write(choice, file.temporary(), scene_.name, bar, stop_);
      if (!written) return bad_output(file.target().string() + ": " + written.error());
      model = *std::move(written);
      return {};
    };
  }

  std::function<Result()> program_job(const std::filesystem::path& path,
                                      const ProgramStyle& style) {
    return [this, style, &file = output(path)]() -> Result {
      std::ofstream stream(file.temporary(), std::ios::binary);
      const auto writer = make_program_writer(style, scene_, stream);
      if (!writer) return bad_output(file.target().string() + ": " + writer.error());
      const WriteResult written = write_program(program_, **writer);
      if (!written) return bad_output(file.target().string() + ": " + written.error());
      return {};
    };
  }

  Result run_jobs(const std::vector<std::function<Result()>>& jobs) const {
    std::vector<std::future<Result>> running;
    const auto policy = options_.threads > 1 ? std::launch::async : std::launch::deferred;
    running.reserve(jobs.size());
    for (const auto& job : jobs) running.push_back(std::async(policy, job));
    Result all;
    for (auto& job : running)
      if (Result one = job.get(); !one && all) all = std::move(one);
    return all;
  }

  Result write_page() {
    progress_.show("drawing the report", 0);
    const auto pictures = fit_pictures(sculpture_->snapshot(), MeshDistance(*part_),
                                       verdict_->tolerance_mm, pool_, stop_);
    return write_text(*options_.page,
                      verify_page({*verdict_, *simulation_, scene_, report_, text_, pictures}));
  }

  Result write_report() {
    warn_of_idle_run(report_);
    Result done;
    // With the accuracy as carved, which thin walls may have refined.
    if (options_.write_scene)
      done = write_text(*options_.write_scene, scene_text(scene_, options_, *options_.write_scene));
    if (done && options_.page) done = write_page();
    if (!done || !options_.report) return done;
    report_.threads = options_.threads;
    report_.total_s = whole_.lap();
    return write_text(*options_.report, report_json(report_, scene_, program_));
  }

  Result write_text(const std::filesystem::path& path, const std::string& text) {
    OutputFile& file = output(path);
    std::ofstream stream(file.temporary(), std::ios::binary);
    stream << text;
    if (!stream.flush()) return bad_output(file.target().string() + ": cannot be written");
    return {};
  }

  OutputFile& output(const std::filesystem::path& path) { return outputs_.add(path); }

  const CarveOptions& options_;
  OutputFiles& outputs_;
  std::stop_token stop_;
  ThreadPool pool_;
  Stopwatch watch_, whole_;
  Progress progress_;
  Scene scene_;
  Program program_;
  std::optional<WallCheck> walls_;
  std::unique_ptr<Sculpture> sculpture_;
  std::optional<DexelSnapshot> uncut_;
  std::optional<IndexedMesh> reference_;  ///< of --deviation
  std::optional<IndexedMesh> part_;       ///< of --reference
  std::optional<Simulation> simulation_;
  std::optional<Verdict> verdict_;
  std::string text_;  ///< of the program
  std::unique_ptr<CarvedSurface> surface_;
  CarveReport report_;
};

int fail(const Failure& failure) {
  std::cerr << failure.line << '\n';
  return failure.status;
}

}  // namespace

int run_carve(const CarveOptions& options) {
  if (options.explain || options.derive) {
    const auto text = options.explain ? explained_text(*options.explain) : derived_text(options);
    if (!text) return fail(text.error());
    std::cout << *text;
    return 0;
  }
  OutputFiles outputs;
  const StopSignal signal([&outputs] {
    outputs.abandon();
    std::cerr << kInterrupted << "; unfinished work was abandoned\n";
  });
  // Temporary: freeing the block is covered by the signal's deadline too.
  const auto done = Carving(options, outputs, signal.token()).run();
  return done ? *done : fail(done.error());
}

}  // namespace kerf
