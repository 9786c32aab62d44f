// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/milling_presets.h"

namespace kerf {
namespace {

// Coefficients differ between publications by a factor of two and more, because they apply to one
// cutter, speed and lubrication. A coefficient that a source does not state is 0 here.

constexpr const char* kAluminiumReview =
    "Milling force model for aviation aluminum alloy: academic insight and perspective analysis, "
    "Chinese Journal of Mechanical Engineering 34 (2021), doi:10.1186/s10033-021-00536-9, table 5";
constexpr const char* kWoodTable =
    "Zerspanung von Holz und Holzwerkstoffen, 2nd ed. (2023), ISBN 978-3-446-47769-8, p. 120, as "
    "quoted in FreeCAD's material cards (CC-BY 3.0)";
constexpr const char* kMetalTable =
    "Tabellenbuch Zerspantechnik, 5th ed. (2022), ISBN 978-3-7585-1315-2, p. 215, as quoted in "
    "FreeCAD's material cards (CC-BY 3.0)";
constexpr const char* kKienzleVictor =
    "O. Kienzle, H. Victor: Spezifische Schnittkräfte bei der Metallbearbeitung, Werkstattstechnik "
    "und Maschinenbau 47 (1957), pp. 224-225";
constexpr const char* kMerchant =
    "M. E. Merchant: Mechanics of the metal cutting process II, J. Appl. Phys. 16 (1945), pp. "
    "318-324, with the yield stress of POM-H in FreeCAD's material card (MatWeb's mean)";

// Wood: B. Ettelt's k h^-0.5 across the grain (Kivimaa's direction A), the middle of the range of
// k. Limewood is not in his table; its k is the mean k per density of his five woods, times its own
// density. Steel: kc1.1 times 1.2 for milling, at a rake of 6 degrees. POM: Merchant's chip without
// rake, cut at the yield stress Y with the friction m, has Y (m + sqrt(1 + m^2)) along the cut and
// m times that across.
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
    {"limewood",
     {24.9, 0, 0},
     {0, 0, 0},
     0.5,
     kWoodTable,
     "not in the table: 46.5 per g/cm3 of its woods, within 14 %, at 0.535; tangential only"},
    {"oak", {33, 0, 0}, {0, 0, 0}, 0.5, kWoodTable, "22 to 44; tangential only"},
    {"pine", {22.5, 0, 0}, {0, 0, 0}, 0.5, kWoodTable, "14 to 31; tangential only"},
    {"pom",
     {82.1, 16.4, 0},
     {0, 0, 0},
     0,
     kMerchant,
     "not measured: yield stress 67.3 N/mm2, friction 0.2 (0.1 to 0.3); sharp edge, without axial "
     "coefficients"},
    {"spruce", {21.5, 0, 0}, {0, 0, 0}, 0.5, kWoodTable, "15 to 28; tangential only"},
    {"steel-c45",
     {2664, 0, 0},
     {0, 0, 0},
     0.14,
     kKienzleVictor,
     "Ck45: 2220 N/mm2, m 0.14; tangential only"},
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
