// SPDX-License-Identifier: Apache-2.0
// The missed depth of turning motions, by a directed search for the worst case.

#include "tests/kernel/sweep/missed_depth.h"

#include "tests/support/test.h"

namespace kerf::test::missed_depth_test {
namespace {

/// Found by the search in kernel version 5, in units of the tolerance: an end that moves inwards at
/// the first station, outwards after it, and inwards again before the last one, which is outermost
/// (1.8, 2.6 and 2.2); a wall that closes the gap to a ray and tips past it (12.8).
const MissCase kFound[] = {
    {5, 15, {0.315501766,  0.971397553, 0.131260122, 0.465699011, 0.396996384, 0.552479094,
             0.164154203,  0.692550518, 0.146161286, 0.673927005, 0.467164927, 0.448285999,
             0.0931283486, 0.286357176, 0.85493258,  0.862250234, 0.174024968, 0.0455567934,
             0.575268883,  0.155860566, 0.882325432, 0.638453814, 0.0482306167}},
    {0,
     15,
     {0.834824053,
      1,
      0.667062139,
      0.361578241,
      0.367111179,
      0.0197574226,
      0.624329022,
      0.88363305,
      0.965541131,
      0.428142747,
      0.0517896904,
      0.649963403,
      0.768860488,
      0.194567608,
      0.548823122,
      0.44701025,
      0.61758092,
      0.612431313,
      0.291549832,
      0.465000754,
      0.637012837,
      0.984309959,
      1}},
    {5, 15, {0.222377414, 0.00835708916, 0.32600135,  0.91379878,  0.195846359, 0.905886128,
             0.035586335, 0.642257699,   0.694971484, 0.861653555, 0.17775288,  0.172914268,
             0.754892792, 0.129228772,   0.595430455, 0.133851563, 0.465203274, 0.156828055,
             0.555215565, 0.247433821,   0.934150708, 0.360035374, 0.924116356}},
    {5, 15, {0.32568662,  0.413369729, 0.105303725, 0.773631839, 0.166580453, 0.0590430737,
             0.118843052, 0.644392149, 0.712899952, 0.797424895, 0.166220975, 0.0595595126,
             1,           0.28560364,  0.783387001, 0.346294053, 0.56036971,  0.758643933,
             0.340265752, 0.220611795, 0.467580342, 0.227196197, 0.444791263}},
};

TEST(MissedDepth, StaysWithinTheToleranceInFormerFailures) {
  for (const MissCase& c : kFound) EXPECT_LE(missed_depth(c), 1) << c.tool;
}

TEST(MissedDepth, StaysWithinTheToleranceInADirectedSearch) {
  MissSearch search(1);
  double worst = 0;
  for (const MissCase& c : kFound) {
    double depth = 0;
    search.climb_near(c, depth);
    EXPECT_LE(depth, 1) << c.tool;
    worst = std::max(worst, depth);
  }
  EXPECT_GT(worst, 0.01) << "the search found nothing that is missed at all";
}

}  // namespace
}  // namespace kerf::test::missed_depth_test
