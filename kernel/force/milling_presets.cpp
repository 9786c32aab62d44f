// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/milling_presets.h"

namespace kerf {
namespace {

// Coefficients differ between publications by a factor of two and more, because they hold for one
// cutter, speed and lubrication. What a source does not state is 0 here.

constexpr const char* kAluminiumReview =
    "Milling force model for aviation aluminum alloy: academic insight and perspective analysis, "
    "Chinese Journal of Mechanical Engineering 34 (2021), doi:10.1186/s10033-021-00536-9, table 5";
constexpr const char* kWoodTable =
    "Zerspanung von Holz und Holzwerkstoffen, 2nd ed. (2023), ISBN 978-3-446-47769-8, p. 120, as "
    "quoted in FreeCAD's material cards (CC-BY 3.0)";
constexpr const char* kMetalTable =
    "Tabellenbuch Zerspantechnik, 5th ed. (2022), ISBN 978-3-7585-1315-2, p. 215, as quoted in "
    "FreeCAD's material cards (CC-BY 3.0)";

// Wood: B. Ettelt's k h^-0.5 across the grain (Kivimaa's direction A), the middle of the range of
// k. Steel: kc1.1 times 1.2 for milling, at a rake of 6 degrees.
constexpr MillingPreset kPresets[] = {
    {"aluminium-6061",
     {243.77, 113.5, 0},
     {7.53, 7.83, 0},
     0,
     kAluminiumReview,
     "ref. 160: Al6061-T6, carbide, dry; without axial coefficients"},
    {"aluminium-6082",
     {631, 99, 273},
     {13, 10, 2.8},
     0,
     kAluminiumReview,
     "ref. 189: Al6082-T6, carbide, dry"},
    {"aluminium-7075",
     {767.01, 168.8, 222},
     {27.7, 26.6, 0.7},
     0,
     kAluminiumReview,
     "ref. 190: Al7075-T6, carbide, dry"},
    {"balsa", {6.5, 0, 0}, {0, 0, 0}, 0.5, kWoodTable, "4 to 9; tangential only"},
    {"beech", {33, 0, 0}, {0, 0, 0}, 0.5, kWoodTable, "26 to 40; tangential only"},
    {"oak", {33, 0, 0}, {0, 0, 0}, 0.5, kWoodTable, "22 to 44; tangential only"},
    {"pine", {22.5, 0, 0}, {0, 0, 0}, 0.5, kWoodTable, "14 to 31; tangential only"},
    {"spruce", {21.5, 0, 0}, {0, 0, 0}, 0.5, kWoodTable, "15 to 28; tangential only"},
    {"steel-low-alloy",
     {2640, 0, 0},
     {0, 0, 0},
     0.24,
     kMetalTable,
     "2200 N/mm2, m 0.24; tangential only"},
    {"steel-mild",
     {2160, 0, 0},
     {0, 0, 0},
     0.20,
     kMetalTable,
     "1800 N/mm2, m 0.20; tangential only"},
};

}  // namespace

std::span<const MillingPreset> milling_presets() { return kPresets; }

}  // namespace kerf
