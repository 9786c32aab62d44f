// SPDX-License-Identifier: Apache-2.0
#include "server/formats/scene_force_reader.h"

#include <algorithm>
#include <string>

#include "kernel/force/milling_presets.h"

namespace kerf {
namespace {

constexpr const char* kMillingFields[] = {"material",
                                          "spindle_rpm",
                                          "teeth",
                                          "helix_deg",
                                          "feed_per_tooth_mm",
                                          "runout_mm",
                                          "ripple_hz",
                                          "scale",
                                          "tangential_n_per_mm2",
                                          "radial_n_per_mm2",
                                          "axial_n_per_mm2",
                                          "tangential_edge_n_per_mm",
                                          "radial_edge_n_per_mm",
                                          "axial_edge_n_per_mm",
                                          "chip_exponent",
                                          "tangential_chip_exponent",
                                          "radial_chip_exponent",
                                          "axial_chip_exponent"};

/// Reads an optional number, from 0 to `most`.
double up_to(SceneFields& fields, const std::string& field, double standard, double most) {
  const auto value = fields.find(field);
  if (!value) return standard;
  value->number(-most, most);
  return fields.not_negative(field, standard);
}

void read_material(SceneFields& fields, MillingSettings& milling) {
  const auto value = fields.find("material");
  if (!value) {
    if (!fields.find("tangential_n_per_mm2"))
      fields.reject("material", "is missing; name one, or give tangential_n_per_mm2");
    return;
  }
  const std::string material = value->text();
  const auto presets = milling_presets();
  const auto found = std::ranges::find(presets, material, &MillingPreset::material);
  if (found == presets.end()) {
    std::string known;
    for (const MillingPreset& p : presets)
      known += (known.empty() ? "" : ", ") + std::string(p.material);
    value->reject("\"" + material + "\" is not a known material; use one of " + known +
                  ", or give the coefficients");
  }
  milling.cut_n_per_mm2 = found->cut_n_per_mm2;
  milling.edge_n_per_mm = found->edge_n_per_mm;
  milling.chip_exponents = in_all_directions(found->chip_exponent);
}

/// Reads the exponent of all directions, and those that override it in one.
void read_exponents(SceneFields& fields, EdgeCoefficients& m) {
  if (fields.find("chip_exponent"))
    m = in_all_directions(up_to(fields, "chip_exponent", 0, kChipExponentMax));
  m.tangential = up_to(fields, "tangential_chip_exponent", m.tangential, kChipExponentMax);
  m.radial = up_to(fields, "radial_chip_exponent", m.radial, kChipExponentMax);
  m.axial = up_to(fields, "axial_chip_exponent", m.axial, kChipExponentMax);
}

MillingSettings read_milling(SceneFields& fields) {
  MillingSettings m;
  read_material(fields, m);
  if (const auto rpm = fields.find("spindle_rpm")) {
    m.spindle_rpm = rpm->number(0, kSpindleMaxRpm);
    if (m.spindle_rpm < kSpindleMinRpm) rpm->reject("must be from 1 to 1e6");
  }
  if (const auto teeth = fields.find("teeth")) {
    const double number = teeth->number(0, kTeethMax);
    m.teeth = static_cast<int>(number);
    if (m.teeth != number || m.teeth < 1) teeth->reject("must be a whole number from 1 to 100");
  }
  m.helix_deg = up_to(fields, "helix_deg", m.helix_deg, kHelixMaxDeg);
  m.feed_per_tooth_mm = up_to(fields, "feed_per_tooth_mm", m.feed_per_tooth_mm, kFeedPerToothMaxMm);
  m.runout_mm = up_to(fields, "runout_mm", m.runout_mm, kRunoutMaxMm);
  m.ripple_hz = up_to(fields, "ripple_hz", m.ripple_hz, kForceCoefficientMax);
  m.scale = up_to(fields, "scale", m.scale, 1);
  const auto read = [&](const char* field, double& into) {
    into = up_to(fields, field, into, kForceCoefficientMax);
  };
  read("tangential_n_per_mm2", m.cut_n_per_mm2.tangential);
  read("radial_n_per_mm2", m.cut_n_per_mm2.radial);
  read("axial_n_per_mm2", m.cut_n_per_mm2.axial);
  read("tangential_edge_n_per_mm", m.edge_n_per_mm.tangential);
  read("radial_edge_n_per_mm", m.edge_n_per_mm.radial);
  read("axial_edge_n_per_mm", m.edge_n_per_mm.axial);
  read_exponents(fields, m.chip_exponents);
  return m;
}

ForceLaw read_law(SceneFields& fields) {
  const std::string law = fields.text("law", to_string(ForceLaw::kSpecificEnergy));
  for (const ForceLaw known :
       {ForceLaw::kSpecificEnergy, ForceLaw::kDexelRemovalRate, ForceLaw::kMechanistic}) {
    if (law == to_string(known)) return known;
  }
  fields.reject("law",
                "\"" + law + "\" is not a force law; use specific_energy, drr or mechanistic");
}

}  // namespace

ForceSettings read_force(const SceneValue& value) {
  SceneFields fields(value);
  ForceSettings force;
  force.law = read_law(fields);
  force.specific_force_n_per_mm2 =
      fields.not_negative("specific_force_n_per_mm2", force.specific_force_n_per_mm2);
  force.drr_n_s_per_mm3 = fields.not_negative("drr_n_s_per_mm3", force.drr_n_s_per_mm3);
  force.pivot_mm = fields.not_negative("pivot_mm", force.pivot_mm);
  force.contact_stiffness_n_per_mm =
      fields.not_negative("contact_stiffness_n_per_mm", force.contact_stiffness_n_per_mm);
  if (force.law == ForceLaw::kMechanistic) {
    force.milling = read_milling(fields);
  } else {
    for (const char* field : kMillingFields) {
      if (fields.find(field)) fields.reject(field, "belongs to the force law mechanistic");
    }
  }
  fields.reject_unknown();
  return force;
}

}  // namespace kerf
