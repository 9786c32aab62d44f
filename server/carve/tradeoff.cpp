// SPDX-License-Identifier: Apache-2.0
#include "server/carve/tradeoff.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>
#include <mutex>
#include <numeric>
#include <stop_token>
#include <utility>

#include "server/carve/cpu_budget.h"
#include "server/carve/environment_files.h"
#include "server/carve/failure.h"
#include "server/carve/markup.h"
#include "server/carve/output_file.h"
#include "server/carve/progress.h"
#include "server/carve/stop_signal.h"
#include "server/carve/surface_error.h"
#include "server/carve/tradeoff_plot.h"
#include "server/carve/tradeoff_run.h"
#include "server/carve/tradeoff_table.h"
#include "server/formats/text_file.h"

namespace kerf {
namespace {

// Fractions of the time budget: for all configurations together, and for a single one.
constexpr double kSweepShare = 0.7;
constexpr double kOneShare = 0.25;
// Pitch of the reference relative to the finest one. The ratio is not simple, so that a wall
// aligned with one grid is not aligned with the other.
constexpr double kReferencePitch = 0.38;
constexpr double kReferenceTolerance = 0.1;
// The reference is compared with a coarser one to estimate its own error.
constexpr double kCheckPitch = 1.5;
// Short runs are repeated and the fastest counts, which excludes other load.
constexpr double kRepeatBelowS = 0.3;
constexpr int kRepeats = 3;
// Limit of the distances from cuts, in units of the coarsest pitch.
constexpr double kReachPitches = 4;

constexpr const char* kNotReached = "skipped, interrupted before it was measured";

using Result = std::expected<void, Failure>;

class Tradeoff {
 public:
  explicit Tradeoff(const TradeoffOptions& options) : options_(options) {}

  Result run(const std::stop_token& stop) {
    stop_ = stop;
    if (auto read = read_input(); !read) return read;
    plan();
    const CpuBudget budget(start_s_ + kOneShare * options_.budget_seconds, stop_);
    cut_surface_ = sample_cut_surface(*truth_, options_.samples, budget.token());
    for (const std::size_t n : cheapest_first())
      if (!stop_.stop_requested()) measure(n);
    if (!stop_.stop_requested()) compare_with_reference();
    progress_.clear();
    print();
    if (stop_.stop_requested())
      return std::unexpected(Failure{StopSignal::status(), "interrupted"});
    return write();
  }
  /// Prints the measured rows and removes unfinished files, from any thread while run() still runs.
  void abandon() {
    outputs_.abandon();
    print();
  }

 private:
  struct Carved {
    double removed_mm3 = 0;
    std::vector<Vec3> forces_n;
  };

  Result read_input() {
    auto scene = load_scene(options_.scene);
    if (!scene) return bad_input(to_string(scene.error()));
    scene_ = *std::move(scene);
    const double pitch = scene_.settings.pitch_mm, tolerance = scene_.settings.tolerance_mm;
    pitches_ = options_.pitches_mm;
    if (pitches_.empty()) pitches_ = {4 * pitch, 2 * pitch, pitch, pitch / 2};
    tolerances_ = options_.tolerances_mm;
    if (tolerances_.empty()) tolerances_ = {10 * tolerance, tolerance, tolerance / 10};
    for (auto* list : {&pitches_, &tolerances_}) {
      std::ranges::sort(*list, std::greater());
      list->erase(std::ranges::unique(*list).begin(), list->end());
    }
    if (scene_.settings.stock_mesh)
      return bad_input("kerf-carve tradeoff: stock from a mesh is not supported");
    for (const double p : pitches_) {
      for (const double t : tolerances_) {
        SculptureSettings settings = scene_.settings;
        settings.pitch_mm = p;
        settings.tolerance_mm = t;
        if (auto made = Sculpture::create(settings); !made)
          return bad_input("kerf-carve tradeoff: " + made.error().reason);
      }
    }
    // Arcs are split at the finest tolerance, so that every configuration carves the same motions.
    scene_.settings.tolerance_mm = tolerances_.back();
    const std::string name = options_.program.string();
    const auto text = read_file(options_.program);
    if (!text) return bad_input(name + ": cannot be read");
    const auto environment = load_environment({}, options_.program);
    if (!environment) return bad_input(environment.error());
    auto program = parse_program(name, *text, scene_, *environment);
    if (!program) return bad_input(to_string(program.error()));
    program_ = *std::move(program);
    if (stop_.stop_requested()) return {};
    if (program_.motions.empty()) return bad_input(name + ": the program has no motions");
    turns_ = std::ranges::any_of(program_.motions, [](const ProgramMotion& motion) {
      return motion.from.axis != motion.to.axis;
    });
    fillets_ = std::ranges::any_of(scene_.tools,
                                   [](const auto& tool) { return tool.second.chords_follow; });
    // The true solid has the fillets of the reference.
    const auto exact = with_tolerance(scene_, reference_tolerance_mm());
    if (!exact) return bad_input(options_.scene.string() + ": " + exact.error());
    truth_ = std::make_unique<TrueSolid>(scene_.settings.stock, exact->tools, program_.motions,
                                         kReachPitches * pitches_.front());
    return {};
  }

  double reference_tolerance_mm() const {
    return std::max(kReferenceTolerance * tolerances_.back(), 1e-6);
  }

  // Without rotation all motion models are equivalent, and all tolerances unless fillets depend on
  // them.
  void plan() {
    const auto either = [](const std::vector<std::string>& asked,
                           const std::vector<std::string>& otherwise) {
      return asked.empty() ? otherwise : asked;
    };
    const std::scoped_lock lock(mutex_);
    const auto rays = either(options_.rays, {"dexel", "tri-dexel"});
    const auto motions = either(options_.motions, {"tight", "paper"});
    for (const double pitch : pitches_) {
      for (const std::string& ray : rays) {
        for (const std::string& motion : motions) {
          for (const double tolerance : tolerances_) {
            if (!turns_ && motion != motions.front()) continue;
            if (!turns_ && !fillets_ && tolerance != tolerances_.back()) continue;
            TradeoffRow& row = rows_.emplace_back();
            row.rays = ray == "tri-dexel" ? Rays::kTriDexel : Rays::kDexel;
            row.motion = motion == "paper" ? MotionModel::kPaper : MotionModel::kTight;
            row.pitch_mm = pitch;
            row.tolerance_mm = tolerance;
            row.skipped = kNotReached;
          }
        }
      }
    }
    results_.resize(rows_.size());
  }

  // Keeps the budget from being spent on the few most expensive configurations.
  std::vector<std::size_t> cheapest_first() const {
    AccuracyUse use{.stock = scene_.settings.stock, .tools = {}, .turns = turns_};
    for (const auto& [id, tool] : scene_.tools) use.tools.push_back(tool.tool);
    const auto cost = [&](std::size_t n) {
      const TradeoffRow& row = rows_[n];
      return predicted_us({row.rays, row.pitch_mm, row.tolerance_mm, row.motion}, use);
    };
    std::vector<std::size_t> order(rows_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, cost);
    return order;
  }

  SculptureSettings settings_of(const TradeoffRow& row) const {
    SculptureSettings settings = scene_.settings;
    settings.rays = row.rays;
    settings.pitch_mm = row.pitch_mm;
    settings.tolerance_mm = row.tolerance_mm;
    settings.motion = row.motion;
    return settings;
  }

  double elapsed_s() const { return Clock::process_cpu_s() - start_s_; }

  std::string too_large(const SculptureSettings& settings) const {
    const double mb = 1e-6 * bytes_if_all_touched(settings);
    if (mb <= options_.budget_mb) return {};
    return "skipped, its stock may need " + formatted("%.0f", mb) + " MB; --budget-mb is " +
           formatted("%.0f", options_.budget_mb);
  }

  // Carves within the budgets. The error names the exceeded one.
  std::expected<CarvedOnce, std::string> carve(const SculptureSettings& settings,
                                               const std::stop_token& stop,
                                               const std::string& phase) {
    if (std::string large = too_large(settings); !large.empty())
      return std::unexpected(std::move(large));
    const auto scene = with_tolerance(scene_, settings.tolerance_mm);
    if (!scene) return std::unexpected("skipped, " + scene.error());
    double reached = 0;
    progress_.show(phase, reached);
    const auto progress = [&](double share) {
      progress_.show(phase, share);
      reached = share;
    };
    auto carved = carve_once(settings, *scene, program_, progress, stop);
    if (!carved && carved.error().empty())
      return std::unexpected(stop_.stop_requested()
                                 ? kNotReached
                                 : "stopped, --budget-seconds allows " +
                                       formatted("%.0f", 100 * reached) + " % of its cuts");
    return carved;
  }

  void measure(std::size_t n) {
    TradeoffRow row = rows_[n];
    Carved result;
    row.skipped = measured(row, result,
                           std::to_string(n + 1) + " of " + std::to_string(rows_.size()) +
                               ": pitch " + formatted("%.4g", row.pitch_mm));
    const std::scoped_lock lock(mutex_);
    rows_[n] = std::move(row);
    results_[n] = std::move(result);
  }

  // Fills the row within its share of the budget. Returns the reason of a failure, or an empty
  // text.
  std::string measured(TradeoffRow& row, Carved& result, const std::string& phase) {
    const double end_s = kSweepShare * options_.budget_seconds;
    const CpuBudget budget(
        start_s_ + std::min(end_s, elapsed_s() + kOneShare * options_.budget_seconds), stop_);
    auto carved = carve(settings_of(row), budget.token(), phase);
    if (!carved) return carved.error();
    for (int again = 1; again < kRepeats && carved->cpu_s < kRepeatBelowS; ++again) {
      const auto repeated = carve(settings_of(row), budget.token(), phase);
      if (repeated) carved->cpu_s = std::min(carved->cpu_s, repeated->cpu_s);
    }
    const auto motions = double(program_.motions.size());
    row.us_per_motion = 1e6 * carved->cpu_s / motions;
    row.bytes = carved->bytes;
    row.sub_motions = carved->sub_motions;
    const DistanceFigures surface =
        measure_surface(carved->snapshot, *truth_, options_.samples, budget.token());
    const DistanceFigures missing = measure_missing(carved->snapshot, cut_surface_, budget.token());
    if (stop_.stop_requested()) return kNotReached;
    if (budget.token().stop_requested())
      return "stopped, --budget-seconds ended while its surface was measured";
    row.missing_mm = missing.max_mm;
    row.surface_max_mm = std::max(surface.max_mm, missing.max_mm);
    row.surface_rms_mm = surface.rms_mm;
    samples_ = std::max(samples_, surface.samples);
    result = {carved->removed_mm3, std::move(carved->forces_n)};
    return {};
  }

  void compare_with_reference() {
    SculptureSettings settings = scene_.settings;
    settings.motion = MotionModel::kTight;
    settings.tolerance_mm = reference_tolerance_mm();
    // Rays along X and Y resolve a floor to half a pitch only, and most programs cut floors.
    settings.rays = Rays::kDexel;
    double finest = 0;
    for (const TradeoffRow& row : rows_)
      if (row.skipped.empty()) finest = row.pitch_mm;
    if (finest == 0) return;
    settings.pitch_mm = fitting_pitch(settings.stock, kReferencePitch * finest);
    const CpuBudget budget(Clock::process_cpu_s() + (1 - kSweepShare) * options_.budget_seconds,
                           stop_);
    const auto reference = carve(settings, budget.token(), "reference");
    if (stop_.stop_requested()) return;
    SculptureSettings coarser = settings;
    coarser.pitch_mm = fitting_pitch(settings.stock, kCheckPitch * settings.pitch_mm);
    const auto check = reference ? carve(coarser, budget.token(), "reference's own error")
                                 : std::expected<CarvedOnce, std::string>(std::unexpected(""));
    const std::scoped_lock lock(mutex_);
    if (!reference) {
      reference_ = "No reference (pitch " + formatted("%.4g", settings.pitch_mm) +
                   " mm): " + reference.error() + ". Volume and force errors are not available.\n";
      return;
    }
    for (std::size_t n = 0; n < rows_.size(); ++n) {
      if (!rows_[n].skipped.empty()) continue;
      rows_[n].volume_error = volume_difference(results_[n].removed_mm3, reference->removed_mm3);
      rows_[n].force_error = force_difference(program_, results_[n].forces_n, reference->forces_n);
    }
    reference_ = "Volume and force are compared with pitch " +
                 formatted("%.4g", settings.pitch_mm) + " mm, tolerance " +
                 formatted("%.3g", settings.tolerance_mm) + " mm, " + to_string(settings.rays) +
                 ", tight";
    if (check)
      reference_ +=
          "; against that, pitch " + formatted("%.4g", coarser.pitch_mm) + " mm differs by " +
          formatted("%.1g", volume_difference(check->removed_mm3, reference->removed_mm3)) +
          " in volume and " +
          formatted("%.1g", force_difference(program_, check->forces_n, reference->forces_n)) +
          " in force";
    reference_ += ".\n";
  }

  static double volume_difference(double removed_mm3, double reference_mm3) {
    return reference_mm3 > 0 ? std::abs(removed_mm3 - reference_mm3) / reference_mm3 : 0;
  }

  // Prints once. A second caller waits until it is done.
  void print() {
    std::call_once(printed_, [this] {
      const std::scoped_lock lock(mutex_);
      if (rows_.empty()) return;
      mark_front(rows_);
      if (options_.target_mm) mark_cheapest(rows_, *options_.target_mm);
      print_table();
      std::cout.flush();
    });
  }

  void print_table() const {
    std::cout << scene_.name << ", " << program_.name << ": " << program_.motions.size()
              << " motions; CPU time of one core of " << machine_name() << "\n\n"
              << tradeoff_text(rows_) << "\n* Pareto front of time and greatest surface error.";
    if (options_.target_mm) std::cout << " < cheapest within " << *options_.target_mm << " mm.";
    std::cout << "\nSurface: " << samples_
              << " or fewer corners and centroids of the mesh against the true solid, and "
              << cut_surface_.points.size() << " points of the cut surface, about "
              << formatted("%.2g", cut_surface_.spacing_mm) << " mm apart, against the mesh.\n"
              << reference_;
    if (!turns_)
      std::cout << "The program has no rotation: the motion model has no effect, and the tolerance "
                << (fillets_ ? "only on fillets.\n" : "none.\n");
  }

  Result write() {
    const std::string title = scene_.name + ", " + options_.program.filename().string();
    const std::string note =
        std::to_string(program_.motions.size()) + " motions; one core of " + machine_name();
    const auto write_one = [this](const std::filesystem::path& path, const std::string& text) {
      const OutputFile& file = outputs_.add(path);
      std::ofstream stream(file.temporary(), std::ios::binary);
      return bool((stream << text).flush());
    };
    constexpr const char* kNotWritten = "kerf-carve tradeoff: a file cannot be written";
    if (options_.csv && !write_one(*options_.csv, tradeoff_csv(rows_)))
      return bad_output(kNotWritten);
    if (options_.svg && !write_one(*options_.svg, tradeoff_svg(rows_, title, note)))
      return bad_output(kNotWritten);
    if (auto done = outputs_.commit(); !done) return bad_output(done.error());
    return {};
  }

  const TradeoffOptions& options_;
  OutputFiles outputs_;
  std::stop_token stop_;
  const double start_s_ = Clock::process_cpu_s();
  Progress progress_;
  Scene scene_;
  Program program_;
  std::vector<double> pitches_, tolerances_;
  bool turns_ = false;
  bool fillets_ = false;  ///< of the tools follow the tolerance
  std::unique_ptr<TrueSolid> truth_;
  CutSurface cut_surface_;
  std::mutex mutex_;  ///< guards the members below against abandon()
  std::vector<TradeoffRow> rows_;
  std::vector<Carved> results_;
  std::size_t samples_ = 0;
  std::string reference_;
  std::once_flag printed_;
};

}  // namespace

int run_tradeoff(const TradeoffOptions& options) {
  Tradeoff tradeoff(options);
  const StopSignal signal([&tradeoff] { tradeoff.abandon(); });
  const auto done = tradeoff.run(signal.token());
  if (done) return 0;
  std::cerr << done.error().line << '\n';
  return done.error().status;
}

}  // namespace kerf
