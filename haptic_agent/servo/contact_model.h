// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "haptic_agent/servo/grip.h"
#include "haptic_agent/servo/server_wrench.h"

namespace kerf::agent {

/// Limits within which a device renders a contact stably, and the mechanics that they follow from.
struct ContactLimits {
  /// Greatest stiffness of the springs, N/mm, and damping of the dampers in parallel, N s/mm, that
  /// the device renders stably at this delay.
  double max_stiffness = 1.5;
  double max_damping = 0.004;
  /// Least mass and inertia of the device (DeviceCapabilities), or 0 if unknown, which limits
  /// nothing.
  double mass_kg = 0;
  double inertia_kg_m2 = 0;
  /// Mean time from a pose to its force (latency and half a period), and from a velocity to its
  /// force, which includes the filter.
  double force_delay_s = 0.001;
  double velocity_delay_s = 0.003;
};

/// Spring and damper of one contact plane: N/mm, N s/mm.
struct ContactGains {
  double stiffness = 0;
  double damping = 0;
};

/// Returns the least mass that a push along `normal` at `arm_mm` from the pivot moves, kg, or 0 if
/// the device's mechanics are unknown.
double moved_mass(const ContactLimits& limits, Vec3 arm_mm, Vec3 normal) noexcept;

/// Returns the damper with which a free mass is stable at the stiffest spring, for the delays of
/// `limits`. `mass` in N s^2/mm gives N s/mm. An inertia in N mm s^2 gives N mm s.
///
/// A spring K that acts τ = force_delay_s late drives like a damper of -K τ, so a damper B must
/// make up for it: K <= B/τ. This is the limit of Colgate and Schenkel, K <= 2 b / (T + 2 L), with
/// a damper B that the loop renders in place of the device's own b, which few drivers know. B acts
/// σ = velocity_delay_s late, so the moved mass m limits it: B <= (0.4 + 0.1 σ/τ) m/σ.
double best_damping(const ContactLimits& limits, double mass) noexcept;

/// Returns the greatest stiffness at which a spring with a damper of `damping`, the best one or
/// weaker, comes to rest on a mass of at least `mass` at the delays of `limits`, with a margin of a
/// fifth. Units as in best_damping. Unbounded if `mass` is 0 (unknown).
///
/// With the best damper a free mass is stable up to K = (1 + τ/σ)/4 m/(τ σ). With a weaker one K
/// falls in proportion to B, or to B / (τ + σ b / (2 - 2 b)) if that is larger, where b = B σ/m is
/// the part of the mass that the late damper takes. ContactLimits.* tests masses from the given one
/// to 1000 times it, latencies of 0 to 3 ms, filters from none to 100 Hz and dampers from the best
/// one to a tenth of it: all come to rest. At 1.5 times the stiffness of the best damper none does.
double stable_stiffness(const ContactLimits& limits, double mass, double damping) noexcept;

/// Returns gains at which a contact of a free device does not oscillate. `arm_mm`: from the pivot
/// to the contact. A push along `normal` there also turns the device and so moves less mass.
/// `share`: of the load that this contact bears, 0 to 1.
ContactGains stable_gains(const ContactLimits& limits, double stiffness, Vec3 arm_mm, Vec3 normal,
                          double share) noexcept;

/// Renders the contact planes of the newest answer as damped springs that act on the moving tool
/// between two answers. All contacts together are as stiff as the device permits. Each has a share
/// in proportion to its depth, so a contact that is just touched changes nothing. The points of one
/// contact share equally at any depth, so that they act as springs, which return no work over a
/// cycle. A difference between the planes of two answers fades in, so that a new answer never
/// causes a step of the force.
class ContactModel {
 public:
  /// Longest time constant with which a difference between two answers fades, s. The usual one is
  /// twice the age of the newer answer.
  static constexpr double kFadeS = 0.015;

  /// Ignores planes that have none of `flags` (wire::ContactPlane).
  explicit ContactModel(const ContactLimits& limits,
                        std::uint32_t flags = wire::kContactStock | wire::kContactObstacle) noexcept
      : limits_(limits), flags_(flags) {}

  /// Sets the newest answer. `then`: the grip that it answers; `now`, `velocity`: the newest ones.
  void take(const ServerWrench& answer, const Grip& then, const Grip& now,
            const Twist& velocity) noexcept;
  /// Returns force and torque about the pivot, `dt_s` after the last call.
  Wrench at(const Grip& now, const Twist& velocity, double dt_s) noexcept;
  /// Returns the wrench of the surfaces' own undamped springs, as the session computes it, at the
  /// grip of the last call of `at`.
  const Wrench& computed() const noexcept { return computed_; }
  /// Returns the part of the answer's own wrench that these planes contribute.
  Wrench in_answer() const noexcept;

 private:
  /// A plane that pushes at a grip, and the contact to which it belongs.
  struct Touch {
    const wire::ContactPlane* plane;
    Vec3 arm_mm;
    double depth_mm, fade;
    std::uint32_t contact;
  };
  struct Touches {
    std::array<Touch, wire::kMaxContactPlanes> all;
    std::uint32_t count = 0;
    /// Number of points of each contact, and the sum of their depths where they push.
    std::array<double, wire::kMaxContactPlanes> points{}, depths_mm{};
    std::uint32_t contacts = 0;
  };
  Touches touches_at(const Grip& grip) const noexcept;
  /// `gains`: called with a plane, the arm to it, a direction, the contact's share of the load, and
  /// the number of its points.
  template <typename Gains>
  static Wrench push(const Touches& touches, Vec3 axis, const Twist& velocity,
                     const Gains& gains) noexcept;
  Wrench damped(const Touches& touches, Vec3 axis, const Twist& velocity) const noexcept;
  static Wrench undamped(const Touches& touches, Vec3 axis) noexcept;

  ContactLimits limits_;
  std::uint32_t flags_;
  ServerWrench answer_;
  Grip then_;
  Wrench fading_;
  double fade_s_ = kFadeS;
  Wrench computed_;
};

}  // namespace kerf::agent
