// SPDX-License-Identifier: Apache-2.0
#include "server/formats/scene_templates.h"

namespace kerf {
namespace {

constexpr SceneTemplate kTemplates[] = {
    {"box", "Box", "A limewood board for carving a relief by hand.", R"({
  "name": "Relief",
  "stock": {"shape": "box", "min_mm": [-60, -40, -20], "max_mm": [60, 40, 0]},
  "accuracy": {"target_mm": 0.2},
  "tools": [
    {"id": 1, "shape": "ball", "diameter_mm": 12, "length_mm": 40},
    {"id": 2, "shape": "ball", "diameter_mm": 6, "length_mm": 40},
    {"id": 3, "shape": "ball", "diameter_mm": 3, "length_mm": 30},
    {"id": 4, "shape": "flat", "diameter_mm": 6, "length_mm": 40}
  ],
  "force": {"law": "specific_energy", "specific_force_n_per_mm2": 0.05, "pivot_mm": 20},
  "machine": {"kinematics": "tool-vector"}
})"},
    {"cylinder", "Cylinder", "An upright cylinder for carving a bust by hand, from all sides.", R"({
  "name": "Bust",
  "stock": {"shape": "cylinder", "center_mm": [0, 0], "radius_mm": 30, "min_z_mm": -80,
            "max_z_mm": 0},
  "accuracy": {"target_mm": 0.3, "rays": "tri-dexel"},
  "tools": [
    {"id": 1, "shape": "ball", "diameter_mm": 12, "length_mm": 40},
    {"id": 2, "shape": "ball", "diameter_mm": 5, "length_mm": 40}
  ],
  "force": {"law": "specific_energy", "specific_force_n_per_mm2": 0.05, "pivot_mm": 20},
  "machine": {"kinematics": "tool-vector"}
})"},
    {"milling", "Milling job", "An aluminum plate for three-axis NC programs.", R"({
  "name": "Milling job",
  "stock": {"shape": "box", "min_mm": [0, 0, -25], "max_mm": [120, 80, 0]},
  "accuracy": {"target_mm": 0.1},
  "tools": [
    {"id": 1, "shape": "flat", "diameter_mm": 10, "length_mm": 30,
     "shank": {"diameter_mm": 10, "length_mm": 20}},
    {"id": 2, "shape": "flat", "diameter_mm": 6, "length_mm": 20,
     "shank": {"diameter_mm": 6, "length_mm": 30}},
    {"id": 3, "shape": "ball", "diameter_mm": 6, "length_mm": 20,
     "shank": {"diameter_mm": 6, "length_mm": 30}}
  ],
  "force": {"law": "mechanistic", "material": "aluminium-6061", "spindle_rpm": 12000, "teeth": 2,
            "scale": 0.02, "pivot_mm": 20},
  "machine": {"kinematics": "xyz"}
})"},
    {"five-axis", "5-axis study", "A cylinder on a tilting rotary table (axes A and C).", R"({
  "name": "5-axis study",
  "stock": {"shape": "cylinder", "center_mm": [0, 0], "radius_mm": 40, "min_z_mm": -40,
            "max_z_mm": 0},
  "accuracy": {"target_mm": 0.2},
  "tools": [
    {"id": 1, "shape": "ball", "diameter_mm": 8, "length_mm": 40,
     "shank": {"diameter_mm": 8, "length_mm": 30}},
    {"id": 2, "shape": "ball", "diameter_mm": 4, "length_mm": 25,
     "shank": {"diameter_mm": 4, "length_mm": 30}}
  ],
  "force": {"law": "specific_energy", "specific_force_n_per_mm2": 0.05, "pivot_mm": 60},
  "machine": {"kinematics": "xyzac-trt"}
})"},
    {"ammonite", "Ammonite", "The block of the ammonite demo, not carved yet.", R"({
  "name": "ammonite",
  "stock": {"shape": "box", "min_mm": [-60, -48, -32], "max_mm": [60, 48, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.4, "tolerance_mm": 0.02, "motion": "tight"},
  "tools": [
    {"id": 1, "shape": "ball", "diameter_mm": 12, "length_mm": 30},
    {"id": 2, "shape": "ball", "diameter_mm": 5, "length_mm": 30},
    {"id": 3, "shape": "ball", "diameter_mm": 6, "length_mm": 30},
    {"id": 4, "shape": "ball", "diameter_mm": 3, "length_mm": 30}
  ],
  "force": {"law": "specific_energy", "specific_force_n_per_mm2": 0.05, "pivot_mm": 20},
  "machine": {"kinematics": "tool-vector"}
})"},
};

}  // namespace

std::span<const SceneTemplate> scene_templates() { return kTemplates; }

}  // namespace kerf
