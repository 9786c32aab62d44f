// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/milling_elements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>

#include "kernel/force/milling_contact.h"
#include "kernel/math/int_lanes.h"
#include "kernel/math/rotation.h"
#include "kernel/math/series_lanes.h"
#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Elements are divided into parts of this share of the tool's radius along the rays, so that the
/// angle at which a helical edge cuts them is nearly constant over each.
constexpr double kPartShare = 0.2;
constexpr int kPartsMax = 256;
/// Least number of parts on long paths, because the surface reaches them at different angles.
constexpr int kPartsLong = 4;
/// Approximate number of parts that one sub-motion sums. Of more, every n-th element counts n
/// times.
constexpr double kPartsMost = 16384;
/// The same for short paths: those of a tick, which differ little from one to the next.
constexpr double kPartsMostNear = 1024;
/// Approximate least number of elements that are summed, if there are as many.
constexpr double kElementsLeast = 128;
/// The same for walls along the rays. Below twice as many, all are summed. These elements are the
/// columns of a thin arc, and a few grazed ones have much of the edges' force, so sums of few of
/// them would differ from tick to tick.
constexpr double kWallElementsLeast = 1024;
/// Least sine of the angle between the surface and the displacement. Where the edge of an
/// engagement grazes the surface, one column would count as an unbounded area.
constexpr double kGrazingSine = 0.02;
/// Least distance from the axis, in radii of the tool, because the cutting speed is zero on the
/// axis.
constexpr double kAxisShare = 0.05;
/// Most evaluations of the surface in the search for the pose at which a motion cut an element.
constexpr int kEntryEvaluations = 8;
/// Paths below half a pitch or this share of the radius are short: the surface and its normal at
/// the start are those at the entry.
constexpr double kNearShare = 0.02;
/// Distance from the surface, in radii of the tool, at which the search ends.
constexpr double kEntryShare = 0.0005;

/// Forces in the tool's frame (MillingContact), and torques about the pivot without the component
/// about the axis, for eight elements or as sums over them.
struct Pushes {
  Lanes x, y, axial, turn_x, turn_y;

  KERF_INLINE void add(const Pushes& p, const Lanes& scale) {
    x = x + p.x * scale;
    y = y + p.y * scale;
    axial = axial + p.axial * scale;
    turn_x = turn_x + p.turn_x * scale;
    turn_y = turn_y + p.turn_y * scale;
  }
};

/// Sums of the pushes: the mean, and the cosines and sines of each frequency.
struct PushSpectrum {
  Pushes mean, cosine[kHarmonicsMax], sine[kHarmonicsMax];

  KERF_INLINE void add(int harmonic, const Pushes& p, const PhaseLanes& phase) {
    cosine[harmonic].add(p, phase.cosine);
    sine[harmonic].add(p, phase.sine);
  }
};

/// State of the sums over the elements of one sub-motion.
struct MillingSums {
  Lanes volume, length;  ///< volume over the area of a column
  PushSpectrum cut, edge;
};

/// The tool's frame in that of a field. Converts vectors to the tool's frame and back.
struct ToolFrame {
  Vec3 zero, quarter, axis;

  Vec3 of(Vec3 v) const { return {dot(v, zero), dot(v, quarter), dot(v, axis)}; }
  Vec3 field(Vec3 v) const { return zero * v.x + quarter * v.y + axis * v.z; }
};

/// Coefficients of eight elements, times the quantities to which they apply.
struct EdgeLanes {
  Lanes tangential, radial, axial;

  KERF_INLINE EdgeLanes operator*(const EdgeCoefficients& k) const {
    return {tangential * k.tangential, radial * k.radial, axial * k.axial};
  }
  KERF_INLINE EdgeLanes operator*(const Lanes& scale) const {
    return {tangential * scale, radial * scale, axial * scale};
  }
};

/// Returns (h / 1 mm)^−m in each direction.
KERF_INLINE EdgeLanes thinned(const Lanes& chip_mm, const EdgeCoefficients& m) {
  if (m == EdgeCoefficients{}) return {Lanes(1), Lanes(1), Lanes(1)};
  const Lanes chip = greater(chip_mm, Lanes(kRestFeedMm));
  const Lanes tangential = power(chip, -m.tangential);
  const Lanes radial = m.radial == m.tangential ? tangential : power(chip, -m.radial);
  const Lanes axial = m.axial == m.radial ? radial : power(chip, -m.axial);
  return {tangential, radial, axial};
}

/// Inputs of the sums over a sub-motion, and its tool's frame.
struct ElementSums {
  const MillingPass& pass;
  ToolFrame frame;
  Vec3 first, pitch_x, pitch_y, quantum;  ///< of column (0, 0) at depth 0, and steps of the grid
  Vec3 linear, angular;                   ///< of the twist
  bool common;                            ///< all elements have one path
  double pivot_mm, pitch_mm, quantum_mm, part_mm, turns_per_mm;
  double near_mm;  ///< paths up to this length are short
  int parts_min;   ///< least number of parts of an element

  ElementSums(const DexelGrid& grid, const MillingPass& p);
  KERF_INLINE PathLanes path_of(const Vec3Lanes& at) const;
  KERF_INLINE Pushes push(const EdgeLanes& k, const MillingContact& c) const;
  KERF_INLINE void add_ripple(const MillingContact& c, const Pushes& cut, const Pushes& edge,
                              const EdgeLanes& thinner, MillingSums& sums) const;
  KERF_INLINE void add_part(const Vec3Lanes& middle, const Lanes& length, const Lanes& share,
                            ContactSearch& search, MillingSums& sums) const;
  KERF_INLINE int parts_of(const Lanes& quanta) const;
  KERF_INLINE void add_elements(const Lanes& i, const Lanes& j, const Lanes& bottom,
                                const Lanes& top, const Lanes& share, ContactSearch& search,
                                MillingSums& sums) const;
};

double tangent(double deg) {
  const SinCos sc = sin_cos(deg * kMillingPi / 180);
  return sc.sin / sc.cos;
}

/// Returns an upper bound of the paths of a sub-motion's elements.
double longest_path_mm(const MillingPass& p) {
  return length(p.twist.linear) + length(p.twist.angular) * p.frame.reach_mm;
}

ElementSums::ElementSums(const DexelGrid& grid, const MillingPass& p)
    : pass(p),
      frame{p.zero, cross(p.zero, p.frame.axis), p.frame.axis},
      first(frame.of(Vec3{grid.x_mm(0), grid.y_mm(0), grid.z_mm(0)} - p.frame.tip_mm)),
      pitch_x(frame.of({grid.pitch_mm, 0, 0})),
      pitch_y(frame.of({0, grid.pitch_mm, 0})),
      quantum(frame.of({0, 0, grid.z_quantum_mm})),
      linear(frame.of(p.twist.linear)),
      angular(frame.of(p.twist.angular)),
      common(length(p.twist.angular) * p.frame.reach_mm <=
             kCommonDirectionShare * length(p.twist.linear)),
      pivot_mm(p.frame.pivot_mm),
      pitch_mm(grid.pitch_mm),
      quantum_mm(grid.z_quantum_mm),
      part_mm(kPartShare * p.frame.radius_mm),
      turns_per_mm(tangent(p.settings.helix_deg) / p.frame.radius_mm / (2 * kMillingPi)),
      near_mm(std::max(grid.pitch_mm / 2, kNearShare * p.frame.radius_mm)),
      parts_min(longest_path_mm(p) > near_mm ? kPartsLong : 1) {}

KERF_INLINE PathLanes ElementSums::path_of(const Vec3Lanes& at) const {
  // The frame is left-handed, so the cross product has the other sign.
  const Vec3Lanes path = common ? linear * Lanes(1) : linear + cross(angular, at) * Lanes(-1);
  const Lanes length_mm = square_root(dot(path, path));
  return {path * select(length_mm > 0.0, 1.0 / length_mm, Lanes()), length_mm};
}

KERF_INLINE Pushes ElementSums::push(const EdgeLanes& k, const MillingContact& c) const {
  // Along the radius, across it against the tooth's motion, and along the axis.
  const Lanes out = k.axial * c.side.axial - k.radial * c.side.radial;
  const Lanes across = k.tangential;
  const Lanes axial = -(k.axial * c.side.radial + k.radial * c.side.axial);
  const Lanes lever = c.at.z - pivot_mm;
  const Lanes turn_out = -lever * across;
  const Lanes rho = c.at.x * c.cosine + c.at.y * c.sine;
  const Lanes turn_across = lever * out - rho * axial;
  return {out * c.cosine + across * c.sine, out * c.sine - across * c.cosine, axial,
          turn_out * c.cosine + turn_across * c.sine, turn_out * c.sine - turn_across * c.cosine};
}

/// `thinner` is (h / 1 mm)^−m times the length of an element's edge.
KERF_INLINE void ElementSums::add_ripple(const MillingContact& c, const Pushes& cut,
                                         const Pushes& edge, const EdgeLanes& thinner,
                                         MillingSums& sums) const {
  const PhaseLanes angle = PhaseLanes{c.cosine, c.sine} * phase_of_turns(c.at.z * turns_per_mm);
  for (int n = 0; n < pass.harmonics.count; ++n) {
    const PhaseLanes phase = raised(angle, pass.harmonics.multiple[std::size_t(n)]);
    if (n == 0 && pass.harmonics.runout_mm > 0) {
      // The derivative of K h^(1 − m) by h.
      const EdgeCoefficients& m = pass.settings.chip_exponents;
      const EdgeCoefficients slope{1 - m.tangential, 1 - m.radial, 1 - m.axial};
      const EdgeLanes k = thinner * slope * pass.settings.cut_n_per_mm2;
      sums.edge.add(n, push(k * Lanes(pass.harmonics.runout_mm), c), phase);
    } else {
      sums.cut.add(n, cut, phase);
      sums.edge.add(n, edge, phase);
    }
  }
}

/// Adds parts of elements: at `middle` from the tip, of a length along the rays, in columns of a
/// share of the pitch's square.
KERF_INLINE void ElementSums::add_part(const Vec3Lanes& middle, const Lanes& length_mm,
                                       const Lanes& share, ContactSearch& search,
                                       MillingSums& sums) const {
  const PathLanes path = path_of(middle);
  const Vec3Lanes start = middle + path.forward * (path.length_mm * 0.5);
  // Over a short path, the surface and its normal at its start are those at the entry.
  const MillingContact c = any(path.length_mm > near_mm)
                               ? search.entered(start, path, kEntryEvaluations)
                               : search.entered_at_once(start, path);
  Lanes volume = select(path.length_mm > 0.0, length_mm * share, Lanes());
  if (pass.weighted) {
    const Lanes along =
        c.normal_along({Lanes(frame.zero.z), Lanes(frame.quarter.z), Lanes(frame.axis.z)});
    volume = volume * (along * along);
  }
  const Lanes sine = greater(c.normal_along(path.forward), Lanes(kGrazingSine));
  const Lanes scale = volume * c.inverse_rho, edge_scale = scale / sine;
  const EdgeLanes thinner =
      thinned(pass.feed_per_mm * path.length_mm * sine, pass.settings.chip_exponents);
  const Pushes cut = push(thinner * scale * pass.settings.cut_n_per_mm2, c);
  const EdgeLanes edges{edge_scale, edge_scale, edge_scale};
  const Pushes edge = push(edges * pass.settings.edge_n_per_mm, c);
  sums.volume = sums.volume + volume;
  sums.length = sums.length + length_mm;
  sums.cut.mean.add(cut, Lanes(1));
  sums.edge.mean.add(edge, Lanes(1));
  if (pass.harmonics.count == 0) return;
  add_ripple(c, cut, edge, thinner * edge_scale, sums);
}

/// Returns the number of parts into which elements are divided.
KERF_INLINE int ElementSums::parts_of(const Lanes& quanta) const {
  if (!any(quanta * quantum_mm > part_mm)) return parts_min;
  double longest = 0;
  for (int c = 0; c < kLanes; ++c) longest = std::max(longest, quanta[c]);
  return std::min(parts_min + static_cast<int>(longest * quantum_mm / part_mm), kPartsMax);
}

/// Adds elements of columns i of rows j, between two depths.
KERF_INLINE void ElementSums::add_elements(const Lanes& i, const Lanes& j, const Lanes& bottom,
                                           const Lanes& top, const Lanes& share,
                                           ContactSearch& search, MillingSums& sums) const {
  const Lanes quanta = greater(top - bottom, Lanes());
  const Vec3Lanes foot = first + (pitch_x * i + pitch_y * j + quantum * bottom);
  const int parts = parts_of(quanta);
  if (parts == 1)
    return add_part(foot + quantum * (quanta * 0.5), quanta * quantum_mm, share, search, sums);
  // Bounds and nodes (1 − cos πt) / 2. At an end where the surface grazes, the area of the cut
  // grows as the inverse root of the distance, which this integrates exactly.
  const SinCos half = sin_cos(kMillingPi / (2 * parts));
  double cosine = 1, sine = 0;
  const auto advance = [&] {
    const double c = cosine * half.cos - sine * half.sin;
    sine = sine * half.cos + cosine * half.sin;
    cosine = c;
  };
  for (int k = 0; k < parts; ++k) {
    const double begin = cosine;
    advance();
    const double node = (1 - cosine) / 2;
    advance();
    add_part(foot + quantum * (quanta * node), quanta * (quantum_mm * (begin - cosine) / 2), share,
             search, sums);
  }
}

/// The lattice of summed columns: those where (i + slope · j) is a multiple of `every`.
struct Lattice {
  std::int64_t every, slope;

  /// Returns the number of columns from column i of row j to the next one that counts.
  std::int64_t distance(std::int64_t i, std::int64_t j) const {
    const std::int64_t beyond = (i + slope * j) % every;
    return beyond == 0 ? 0 : every - beyond;
  }
};

/// Elements that are summed together.
struct Gathered {
  IntLanes i{}, j{}, bottom{}, top{};
  Lanes share{1};
  int count = 0;
};

KERF_INLINE void add_gathered_in_lanes(Gathered& g, const ElementSums& elements,
                                       ContactSearch& search, MillingSums& sums) {
  elements.add_elements(to_lanes(g.i), to_lanes(g.j), to_lanes(g.bottom), to_lanes(g.top), g.share,
                        search, sums);
  g = {};
}
KERF_FOR_EACH_TARGET(void, add_gathered,
                     (Gathered & g, const ElementSums& elements, ContactSearch& search,
                      MillingSums& sums),
                     (g, elements, search, sums))

/// Adds the elements of groups in columns of the lattice, eight together.
void add_sampled(std::span<const RemovedGroup> groups, const ElementSums& elements,
                 const Lattice& lattice, Gathered& gathered, ContactSearch& search,
                 MillingSums& sums) {
  std::array<double, kLanes> shares{};
  for (const RemovedGroup& g : groups) {
    const ColumnShares* all = elements.pass.shares;
    const bool by_share = all != nullptr && all->of_group(g.i, g.j, shares);
    for (std::int64_t c = lattice.distance(g.i, g.j); c < RemovedGroup::kLanes;
         c += lattice.every) {
      if (g.bottom[c] >= g.top[c]) continue;
      const int k = gathered.count++;
      gathered.i[k] = g.i + static_cast<std::int32_t>(c);
      gathered.j[k] = g.j;
      gathered.bottom[k] = g.bottom[c];
      gathered.top[k] = g.top[c];
      if (by_share) gathered.share.set(k, shares[std::size_t(c)]);
      if (gathered.count == kLanes) add_gathered(gathered, elements, search, sums);
    }
  }
}

/// Returns the number of elements for each one that is summed: odd, because rows and tiles are
/// powers of 2.
std::int64_t every_of(double count, const ElementSums& elements, double length_mm) {
  const double parts = count * elements.parts_min + length_mm / elements.part_mm;
  const double most = elements.parts_min > 1 ? kPartsMost : kPartsMostNear;
  const double wanted = std::min(parts / most, count / kElementsLeast);
  const std::int64_t every = 2 * static_cast<std::int64_t>(wanted / 2 + 0.5) + 1;
  // Elements of a short path are longer than a pitch in walls along the rays.
  if (elements.parts_min > 1 || length_mm <= count * elements.pitch_mm) return every;
  return std::min(every, 2 * static_cast<std::int64_t>(count / kWallElementsLeast / 2) + 1);
}

/// Returns the lattice of the columns that are summed. The slope is near `every` divided by the
/// square of the golden ratio, and coprime to it. Otherwise the lattice would skip columns of all
/// rows, and the force would vary along rows more than across them.
Lattice lattice_of(const Removal& removal, const ElementSums& elements, double length_mm) {
  const std::int64_t every = every_of(double(removal.elements()), elements, length_mm);
  auto slope = static_cast<std::int64_t>(0.381966 * double(every) + 0.5);
  while (std::gcd(slope, every) > 1) ++slope;
  return {every, slope};
}

double summed(const Lanes& lanes) {
  double sum = 0;
  for (int c = 0; c < kLanes; ++c) sum += lanes[c];
  return sum;
}
Wrench summed(const Pushes& p, const ToolFrame& frame, double scale) {
  return Wrench{frame.field({summed(p.x), summed(p.y), summed(p.axial)}),
                frame.field({summed(p.turn_x), summed(p.turn_y), 0})} *
         scale;
}
MillingSpectrum summed(const PushSpectrum& s, const ToolFrame& frame, double scale, int count) {
  MillingSpectrum sum;
  sum.mean = summed(s.mean, frame, scale);
  sum.count = count;
  for (int n = 0; n < count; ++n) {
    sum.cosine[std::size_t(n)] = summed(s.cosine[n], frame, scale);
    sum.sine[std::size_t(n)] = summed(s.sine[n], frame, scale);
  }
  return sum;
}

}  // namespace

MillingSum sum_milling(const Removal& removal, const DexelGrid& grid, const MillingPass& pass) {
  const ElementSums elements(grid, pass);
  const double radius_mm = pass.frame.radius_mm;
  ContactSearch search{pass.side, 1 / (kAxisShare * radius_mm), kEntryShare * radius_mm};
  const double length_mm = double(removal.quanta()) * grid.z_quantum_mm;
  const Lattice lattice = lattice_of(removal, elements, length_mm);
  Gathered gathered;
  MillingSums sums{};
  for (const RemovedPart& part : removal.parts())
    add_sampled(part.groups, elements, lattice, gathered, search, sums);
  if (gathered.count > 0) add_gathered(gathered, elements, search, sums);
  if (pass.evaluations) *pass.evaluations += search.evaluations;
  const double summed_mm = summed(sums.length);
  double scale = grid.pitch_mm * grid.pitch_mm;
  if (lattice.every > 1 && summed_mm > 0) scale *= length_mm / summed_mm;
  const int count = pass.harmonics.count;
  return {summed(sums.volume) * scale, summed(sums.cut, elements.frame, scale, count),
          summed(sums.edge, elements.frame, scale, count)};
}

}  // namespace kerf
