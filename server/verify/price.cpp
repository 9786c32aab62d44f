// SPDX-License-Identifier: Apache-2.0
#include "server/verify/price.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "kernel/dexel/stock_column.h"
#include "kernel/sculpture.h"

namespace kerf {
namespace {

/// A window begins with motions that are not measured: the first one may take an imprint, and the
/// next ones find stock that the program would already have removed.
constexpr std::size_t kWindows = 60, kWindowMotions = 16, kNotMeasured = 2;
constexpr std::size_t kLongWindows = 12;
constexpr double kBudgetS = 1.5;
/// Allocations while a block is carved, without its columns and the buffers that it counts.
constexpr double kWorkingBytes = 5e5;

/// The tiles of all fields that motions can reach.
class ReachedTiles {
 public:
  explicit ReachedTiles(const Scene& scene) : stock_(stock_bounds(scene.settings.stock)) {
    const bool all = scene.settings.rays == Rays::kTriDexel;
    for (const RayAxis axis : {RayAxis::kZ, RayAxis::kX, RayAxis::kY}) {
      if (axis == RayAxis::kZ || all) fields_.emplace_back(axis, stock_, scene.settings.pitch_mm);
    }
    side_mm_ = kTileSide * scene.settings.pitch_mm;
  }

  void add(const ProgramMotion& motion, const Tool& tool) {
    const double path_mm = length(motion.to.tip_mm - motion.from.tip_mm) +
                           tool.length_mm * length(motion.to.axis - motion.from.axis);
    // Boxes of short pieces, so that a diagonal reaches no more tiles than necessary.
    const double count = std::clamp(std::ceil(path_mm / side_mm_), 1.0, 1e4);
    ToolPose from = motion.from;
    for (int n = 1; n <= int(count); ++n) {
      const double s = n / count;
      const ToolPose to{motion.from.tip_mm + (motion.to.tip_mm - motion.from.tip_mm) * s,
                        normalized(motion.from.axis + (motion.to.axis - motion.from.axis) * s)};
      add_piece(from, to, tool);
      from = to;
    }
  }
  double count() const {
    double sum = 0;
    for (const Field& field : fields_) sum += field.count;
    return sum;
  }
  double all() const {
    double sum = 0;
    for (const Field& field : fields_) sum += double(field.reached.size());
    return sum;
  }

 private:
  struct Field {
    Field(RayAxis of, const BoxStock& stock, double pitch_mm)
        : axis(of), low(to_frame(of, stock.min_mm)), side_mm(kTileSide * pitch_mm) {
      const Vec3 size = to_frame(of, stock.max_mm) - low;
      x = std::max<std::int64_t>(1, std::int64_t(std::ceil(size.x / side_mm)));
      y = std::max<std::int64_t>(1, std::int64_t(std::ceil(size.y / side_mm)));
      reached.resize(std::size_t(x * y));
    }
    void add(Vec3 from, Vec3 to) {
      const auto tile = [this](double at, double low_mm, std::int64_t tiles) {
        return std::clamp(std::int64_t(std::floor((at - low_mm) / side_mm)), std::int64_t{0},
                          tiles - 1);
      };
      for (auto j = tile(from.y, low.y, y); j <= tile(to.y, low.y, y); ++j) {
        for (auto i = tile(from.x, low.x, x); i <= tile(to.x, low.x, x); ++i) {
          const auto at = std::size_t(j * x + i);
          count += reached[at] ? 0 : 1;
          reached[at] = true;
        }
      }
    }
    RayAxis axis;
    Vec3 low;
    double side_mm;
    std::int64_t x = 0, y = 0;
    std::vector<bool> reached;
    double count = 0;
  };

  void add_piece(const ToolPose& from, const ToolPose& to, const Tool& tool) {
    Vec3 low{1e300, 1e300, 1e300}, high = -low;
    for (const ToolPose& pose : {from, to}) {
      for (const double z : {0.0, tool.length_mm}) {
        const Vec3 p = pose.tip_mm + pose.axis * z;
        const auto across = [&](double a) {
          return tool.radius_mm * std::sqrt(std::max(0.0, 1 - a * a));
        };
        const Vec3 r{across(pose.axis.x), across(pose.axis.y), across(pose.axis.z)};
        low = {std::min(low.x, p.x - r.x), std::min(low.y, p.y - r.y), std::min(low.z, p.z - r.z)};
        high = {std::max(high.x, p.x + r.x), std::max(high.y, p.y + r.y),
                std::max(high.z, p.z + r.z)};
      }
    }
    const Vec3 a{std::max(low.x, stock_.min_mm.x), std::max(low.y, stock_.min_mm.y),
                 std::max(low.z, stock_.min_mm.z)};
    const Vec3 b{std::min(high.x, stock_.max_mm.x), std::min(high.y, stock_.max_mm.y),
                 std::min(high.z, stock_.max_mm.z)};
    if (!(a.x < b.x && a.y < b.y && a.z < b.z)) return;
    for (Field& field : fields_) field.add(to_frame(field.axis, a), to_frame(field.axis, b));
  }

  BoxStock stock_;
  double side_mm_ = 0;
  std::vector<Field> fields_;
};

/// A block and the cost of its sample so far.
class Sample {
 public:
  Sample(const Scene& scene, const CostMeter& meter)
      : scene_(scene),
        meter_(meter),
        begun_s_(meter.cpu_s()),
        block_(Sculpture::create(scene.settings)) {
    if (!block_) return;
    for (const auto& [id, tool] : scene.tools) (void)block_->apply(DefineTool{id, tool.tool});
    empty_bytes_ = double(block_->memory_bytes());
  }
  /// Carves motions and measures those from `measured` on. Returns false when the time is used up.
  bool carve(std::span<const ProgramMotion> motions, std::size_t measured) {
    // A sample estimated to fit is not ended by a small excess.
    constexpr double kMostS = 3 * kBudgetS;
    Spent start = spent();
    for (std::size_t n = 0; n < motions.size(); ++n) {
      if (n == measured) start = spent();
      carve_one(motions[n]);
      if (n % kWindowMotions != kWindowMotions - 1 && n + 1 < motions.size()) continue;
      const bool is_over = meter_.cpu_s() - begun_s_ > kMostS;
      if (n >= measured && (is_over || n + 1 == motions.size())) {
        const Spent end = spent();
        measured_.cpu_s += end.cpu_s - start.cpu_s;
        measured_.page_faults += end.page_faults - start.page_faults;
        measured_motions_ += double(n + 1 - measured);
      }
      if (is_over) return false;
    }
    return true;
  }
  /// The price as measured, if so many tiles are reached in the end.
  Price price(double tiles) {
    if (!block_) return price_;
    if (measured_motions_ > 0) price_.us_per_motion = 1e6 * measured_.cpu_s / measured_motions_;
    const double share = reached_.count() > 0 ? tiles / reached_.count() : 0;
    price_.bytes = kWorkingBytes + double(block_->working_bytes()) + empty_bytes_ +
                   share * (double(block_->memory_bytes()) - empty_bytes_);
    return price_;
  }
  /// The price of a program of so many motions, which accesses all its memory for the first time.
  Price price_in_new_memory(double tiles, double motions) {
    Price price = this->price(tiles);
    if (!block_ || measured_motions_ == 0) return price;
    const double pages = (price.bytes - empty_bytes_) / PageFaults::kPageBytes;
    const double fault_us = 1e6 * meter_.page_fault_s();
    const double others_us =
        price.us_per_motion - fault_us * double(measured_.page_faults) / measured_motions_;
    price.us_per_motion = std::max(0.0, others_us) + fault_us * pages / motions;
    return price;
  }
  double tiles() const { return reached_.count(); }
  double all_tiles() const { return reached_.all(); }

 private:
  struct Spent {
    double cpu_s = 0;
    std::int64_t page_faults = 0;
  };
  Spent spent() const { return {meter_.cpu_s(), meter_.page_faults()}; }

  void carve_one(const ProgramMotion& motion) {
    const MoveTool move{motion.tool, motion.from, motion.to, motion.duration_s, true};
    if (!block_ || !block_->apply(move)) return;
    ++price_.motions;
    if (const auto tool = scene_.tools.find(motion.tool); tool != scene_.tools.end())
      reached_.add(motion, tool->second.tool);
  }

  const Scene& scene_;
  const CostMeter& meter_;
  double begun_s_;
  std::expected<Sculpture, SculptureError> block_;
  ReachedTiles reached_{scene_};
  double empty_bytes_ = 0, measured_motions_ = 0;
  Spent measured_;
  Price price_;
};

struct Windows {
  std::size_t count, motions, not_measured;
};

/// Carves windows that are spread evenly over a program. Those of odd numbers come first, so that
/// an early end leaves a sample of all parts.
Sample carve_windows(const Scene& scene, std::span<const ProgramMotion> motions,
                     const Windows& windows, const CostMeter& meter) {
  Sample sample(scene, meter);
  const std::size_t size = std::min(windows.motions, motions.size());
  const std::size_t last = motions.size() - size;
  for (const std::size_t first : {std::size_t{1}, std::size_t{0}}) {
    for (std::size_t w = first; w < windows.count; w += 2) {
      const std::size_t at = windows.count > 1 ? w * last / (windows.count - 1) : 0;
      if (!sample.carve(motions.subspan(at, size), std::min(windows.not_measured, size / 2)))
        return sample;
    }
  }
  return sample;
}

}  // namespace

Price price_of_program(const Scene& scene, std::span<const ProgramMotion> motions,
                       const CostMeter& meter) {
  ReachedTiles all(scene);
  for (const ProgramMotion& motion : motions) {
    if (const auto tool = scene.tools.find(motion.tool); tool != scene.tools.end())
      all.add(motion, tool->second.tool);
  }
  const auto count = double(motions.size());
  const auto price = [&](const Windows& windows) {
    return carve_windows(scene, motions, windows, meter).price_in_new_memory(all.count(), count);
  };
  const Price quick = price({kWindows, kWindowMotions, kNotMeasured});
  const double affordable = 1e6 * kBudgetS / std::max(quick.us_per_motion, 1e-3);
  // Carves all of it if possible, because earlier motions make a motion cheaper.
  if (count <= affordable) return price({1, motions.size(), 0});
  const auto length = std::max(kWindowMotions, std::size_t(affordable) / kLongWindows);
  return price({kLongWindows, length, length / 2});
}

std::vector<ProgramMotion> sample_hand(const Scene& scene) {
  constexpr int kRows = 12, kSteps = 40;
  constexpr double kAlongMm = 1, kTurnRad = 2.5 * std::numbers::pi / 180, kDurationS = 0.001;
  const auto largest = std::ranges::max_element(
      scene.tools, {}, [](const auto& one) { return one.second.tool.radius_mm; });
  if (largest == scene.tools.end()) return {};
  const BoxStock stock = stock_bounds(scene.settings.stock);
  const Vec3 size = stock.max_mm - stock.min_mm;
  const double radius = largest->second.tool.radius_mm;
  const double depth = std::min(radius / 3, size.z / 2);
  const bool turns = scene.machine.kinematics != MachineKinematics::kXyz;
  const auto pose = [&](int row, int step) {
    const double x = stock.min_mm.x + size.x / 2 + (step - kSteps / 2) * kAlongMm;
    const double y = stock.min_mm.y + size.y * (row + 0.5) / kRows;
    // To and fro about the x axis, never by more than 20 degrees.
    const double lean = turns ? kTurnRad * (std::abs(step % 32 - 16) - 8) : 0;
    return ToolPose{{x, y, stock.max_mm.z - depth}, {0, std::sin(lean), std::cos(lean)}};
  };
  std::vector<ProgramMotion> motions;
  for (int row = 0; row < kRows; ++row) {
    for (int step = 0; step < kSteps; ++step) {
      motions.push_back({.tool = largest->first,
                         .from = pose(row, step),
                         .to = pose(row, step + 1),
                         .duration_s = kDurationS});
    }
  }
  return motions;
}

Price price_of_hand(const Scene& scene, const CostMeter& meter) {
  Sample sample(scene, meter);
  const std::vector<ProgramMotion> motions = sample_hand(scene);
  const std::span<const ProgramMotion> all = motions;
  constexpr std::size_t kRowMotions = 40;
  for (std::size_t n = 0; n < all.size(); n += kRowMotions) {
    if (!sample.carve(all.subspan(n, kRowMotions), kNotMeasured)) break;
  }
  return sample.price(sample.all_tiles());
}

}  // namespace kerf
