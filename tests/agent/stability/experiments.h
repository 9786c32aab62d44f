// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "haptic_agent/servo/servo_cycle.h"
#include "tests/agent/stability/plant.h"
#include "tests/agent/stability/virtual_line.h"

namespace kerf::agent {

/// Settings: a light device swings through uncut stock for some seconds.
struct Swing {
  ForceMode mode = ForceMode::kModel;
  LineQuality line{};
  double damping_n_s_per_m = 10;  ///< of the cut, with the tool fully engaged
  double seconds = 3;
  bool copy = true;  ///< whether the agent has a replica
};
struct SwingOutcome {
  double fastest_mm_per_s = 0;  ///< free motion reaches 190
  double returned_mj = 0;       ///< greatest over any interval
  double max_force_n = 0;
  bool active = false;  ///< force was active at the end
  std::uint64_t trips = 0;
  /// At most about three times the speed of free motion, at most the tank's energy returned, and no
  /// trips.
  bool stable() const {
    return fastest_mm_per_s <= 600 && returned_mj <= PassivitySettings{}.tank_mj && trips == 0;
  }
};
SwingOutcome swing(const Swing& swing);

/// Path of a simulated hand through a real block without delay, with the server's force per tick.
struct Recording {
  std::vector<DeviceState> poses;
  std::vector<Vec3> force_n;
  /// Tip of a second agent's tool at each tick. Empty without a second agent.
  std::vector<Vec3> another;
};
Recording record_carving(double seconds);
/// The same path while a second agent carves `beside_mm` to the side of the position that the first
/// one reaches `ahead_s` later. Much of the stock there was cut since the replica's last update.
Recording beside_another(const Recording& recording, double ahead_s, double beside_mm = 2);

/// Returns the error of the output force against the server's force without delay along that path:
/// rms of the difference over rms of the force. Both agents have a line of that quality. `intent`:
/// the agent requests the poses of other tools.
double force_error(const Recording& recording, ForceMode mode, const LineQuality& line, bool copy,
                   bool intent = true);

/// Returns the volume that the path removes in a scene with these guides (JSON list, or empty).
double carved_volume_mm3(const Recording& recording, const std::string& guides);

/// Settings: a hand of given mechanics presses the tool against a surface and holds it there.
struct Press {
  PlantMechanics mechanics{};
  LineQuality line{};
  bool sideways = false;  ///< against a wall, which also turns the tool; otherwise along its axis
  bool obstacle = false;  ///< against an obstacle, which only the server knows; else stock
  bool loses_ticks = false;      ///< four in a row, 2 % in all
  bool ignores_latency = false;  ///< the device declares no latency
  bool ignores_inertia = false;  ///< the device declares an inertia so great that it limits nothing
  std::string guides = {};       ///< JSON list; with guides there is no surface
};
struct PressOutcome {
  double returned_mj = 0;    ///< greatest over any interval, in the plant
  double buzz_mm_per_s = 0;  ///< rms speed of the tip while the hand is at rest
  double force_n = 0;        ///< acting force at the end
  double most_force_n = 0;   ///< greatest acting force
  std::uint64_t trips = 0;
};
PressOutcome press(const Press& press);

/// One guide of each kind that the pressed tool meets at the surface of press_scene, along the axis
/// and sideways. One stroke drives the tool on, the other holds it back.
inline constexpr const char* kPressedGuides[] = {
    R"([{"kind":"plane","point_mm":[0,0,0],"normal":[0,0,1]},
        {"kind":"plane","point_mm":[-3,0,0],"normal":[-1,0,0],"stiffness_n_per_mm":20}])",
    R"([{"kind":"depth","lowest_z_mm":0}, {"kind":"depth","lowest_z_mm":-9}])",
    R"([{"kind":"region","min_mm":[-3,-30,-30],"max_mm":[30,30,0],"max_force_n":8}])",
    R"([{"kind":"path","axis_within_deg":0.2,"stiffness_n_per_mm":20,
         "paths":[[[-6,0,-30,0,0,1],[-6,0,10,0,0,1]],[[9,0,3,0,0,1],[40,0,3,0,0,1]]]}])",
    R"([{"kind":"path","axis_within_deg":0.2,"stiffness_n_per_mm":20,
         "turn_stiffness_nmm_per_rad":5000,
         "paths":[[[-6,0,-30,0,0,1],[-6,0,-2,0.5,0,1],[-6,0,10,0,0,1]],
                  [[9,0,3,0,0,1],[40,0,3,0.9,0,1]]]}])",
    R"([{"kind":"stroke","within_mm":1,"max_force_n":8,"stiffness_n_per_mm":20,
         "paths":[[[15,0,3,0,0,1,0,0,-8,0,0,0],[15,0,-90,0,0,1,0,0,-8,0,0,0]],
                  [[-6,0,-10,0,0,1,-3,0,0,0,20,0],[1,0,-10,0,0,1,-3,0,0,0,20,0]]]}])",
    R"([{"kind":"snap","range_mm":6,"stiffness_n_per_mm":5,"max_force_n":8,
         "surface":{"shape":"box","min_mm":[-3,-30,-30],"max_mm":[30,30,0]}}])"};

}  // namespace kerf::agent
