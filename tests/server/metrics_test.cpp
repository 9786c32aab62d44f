// SPDX-License-Identifier: Apache-2.0
#include "server/metrics/metrics.h"

#include "tests/server/session_fixture.h"

namespace kerf::net {
namespace {

class MetricsTest : public SessionTest {
 protected:
  bool has_line(const std::string& line) {
    return metrics.text(*registry).find("\n" + line + "\n") != std::string::npos;
  }
  Metrics metrics;
};

TEST_F(MetricsTest, CountsRejectionsAndResponsesByLabel) {
  metrics.rejected("bad_pose");
  metrics.rejected("bad_pose");
  metrics.http_answered(404);
  EXPECT_TRUE(has_line("kerf_refused_total{code=\"bad_pose\"} 2"));
  EXPECT_TRUE(has_line("kerf_http_responses_total{status=\"404\"} 1"));
}

TEST_F(MetricsTest, CountsDroppedDatagramsByReasonFromZero) {
  metrics.datagram_dropped(DatagramDrop::kReplayed);
  EXPECT_TRUE(has_line("kerf_datagrams_dropped_total{reason=\"replayed\"} 1"));
  EXPECT_TRUE(has_line("kerf_datagrams_dropped_total{reason=\"too_many\"} 0"));
}

TEST_F(MetricsTest, GaugesFollowTheOpenSessions) {
  EXPECT_TRUE(metrics.text(*registry).contains("kerf_sessions 0"));
  const auto session = start();
  EXPECT_TRUE(metrics.text(*registry).contains("kerf_sessions 1"));
  EXPECT_TRUE(has_line("kerf_session_motions{session=\"block\"} 0"));
}

TEST_F(MetricsTest, SortsTurnaroundsIntoBuckets) {
  metrics.motion_answered(80e-6);
  EXPECT_TRUE(has_line("kerf_turnaround_seconds_bucket{le=\"5e-05\"} 0"));
  EXPECT_TRUE(has_line("kerf_turnaround_seconds_bucket{le=\"0.0001\"} 1"));
}

}  // namespace
}  // namespace kerf::net
