// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "tests/formats/carve_fixture.h"
#include "tests/support/test.h"

namespace kerf::test {

using Json = nlohmann::json;
using Corner = std::array<double, 3>;

inline void add_facet(std::string& stl, Corner a, Corner b, Corner c) {
  stl += "facet normal 0 0 0\nouter loop\n";
  for (const Corner& p : {a, b, c})
    stl += "vertex " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " +
           std::to_string(p[2]) + "\n";
  stl += "endloop\nendfacet\n";
}

/// A prism along Y over an outline in X and Z, counterclockwise seen from -Y, as STL. `ears`: the
/// triangles of its ends.
inline std::string prism(const std::vector<std::pair<double, double>>& outline,
                         const std::vector<std::array<std::size_t, 3>>& ears, double from_y,
                         double to_y) {
  std::string stl = "solid p\n";
  const auto at = [&](std::size_t n, double y) {
    return Corner{outline[n % outline.size()].first, y, outline[n % outline.size()].second};
  };
  for (const auto& [a, b, c] : ears) {
    add_facet(stl, at(a, from_y), at(b, from_y), at(c, from_y));
    add_facet(stl, at(c, to_y), at(b, to_y), at(a, to_y));
  }
  for (std::size_t n = 0; n < outline.size(); ++n) {
    add_facet(stl, at(n, from_y), at(n, to_y), at(n + 1, from_y));
    add_facet(stl, at(n + 1, from_y), at(n, to_y), at(n + 1, to_y));
  }
  return stl + "endsolid p\n";
}

inline std::string box_stl(double from_x, double to_x, double from_y, double to_y, double low_z) {
  return prism({{from_x, low_z}, {to_x, low_z}, {to_x, 0}, {from_x, 0}}, {{0, 1, 2}, {0, 2, 3}},
               from_y, to_y);
}

/// A block of 40 x 30 x 10 mm below Z 0 with a slot along Y, 8 mm wide and 2 mm deep.
inline std::string slotted() {
  return prism({{0, -10}, {40, -10}, {40, 0}, {24, 0}, {24, -2}, {16, -2}, {16, 0}, {0, 0}},
               {{0, 1, 5}, {1, 4, 5}, {1, 2, 4}, {2, 3, 4}, {0, 5, 7}, {5, 6, 7}}, 0, 30);
}

inline const std::string kSlotted =
    "--verify p.ngc --reference part.stl --stock 40,30,10 --tool 1=8 --pitch 0.5 --wall-samples 0 ";

class Verify : public KerfCarve {
 protected:
  void SetUp() override {
    KerfCarve::SetUp();
    write("part.stl", slotted());
  }
  // `cuts`: the lines from the fourth on. The tool starts above the beginning of the slot.
  void write_program(const std::string& cuts) const {
    write("p.ngc", "G21 G90 T1 M6\nG0 X20 Y-6 Z5\nF600\n" + cuts + "G0 Z5\nM2\n");
  }
  // Returns the failed checks by name, for a verification with an exit status.
  std::map<std::string, Json> failed(const std::string& arguments, int status) const {
    EXPECT_EQ(run(arguments + " --report r.json"), status) << content("err");
    const Json verdict = Json::parse(content("r.json"))["verdict"];
    EXPECT_EQ(verdict["passes"], status == 0);
    EXPECT_THAT(content("out"), testing::StartsWith(std::string(verdict["answer"]) + "\n"));
    std::map<std::string, Json> checks;
    for (const Json& check : verdict["checks"])
      if (check["count"] != 0) checks.emplace(check["name"], check);
    return checks;
  }
};

}  // namespace kerf::test
