// SPDX-License-Identifier: Apache-2.0
#include "server/metrics/metrics.h"

#include "tests/server/session_fixture.h"

namespace kerf::net::metrics_test {
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

TEST_F(MetricsTest, CertificateDaysAreNegativeAfterExpiry) {
  EXPECT_FALSE(metrics.text(*registry).contains("kerf_certificate_days_left"));
  const auto days_left = [&] {
    const std::string text = metrics.text(*registry);
    return std::stod(text.substr(text.find("\nkerf_certificate_days_left ") + 28));
  };
  const std::chrono::seconds now = std::chrono::duration_cast<std::chrono::seconds>(
      std::chrono::system_clock::now().time_since_epoch());
  metrics.certificate_expires_s = (now + std::chrono::days(30)).count();
  EXPECT_NEAR(days_left(), 30, 0.1);
  metrics.certificate_expires_s = (now - std::chrono::days(2)).count();
  EXPECT_NEAR(days_left(), -2, 0.1);
}

TEST_F(MetricsTest, GaugesFollowTheOpenSessions) {
  EXPECT_TRUE(metrics.text(*registry).contains("kerf_sessions 0"));
  const auto session = start();
  EXPECT_TRUE(metrics.text(*registry).contains("kerf_sessions 1"));
  EXPECT_TRUE(has_line("kerf_session_motions{session=\"block\"} 0"));
}

TEST_F(MetricsTest, GaugesOfTheJournalFollowItsCommits) {
  const auto session = start();
  const auto id = join(*session);
  carve_circle(*session, id, 20);
  ASSERT_TRUE(session->flush());
  const auto value = [&](const std::string& name) {
    const std::string text = metrics.text(*registry);
    const auto at = text.find("\n" + name + "{session=\"block\"} ");
    return at == text.npos ? -1 : std::stod(text.substr(text.find(' ', at + 1)));
  };
  EXPECT_GE(value("kerf_journal_commits_total"), 1);
  EXPECT_GT(value("kerf_journal_commit_seconds_total"), 0);
  EXPECT_EQ(value("kerf_journal_oldest_pending_seconds"), 0);
  EXPECT_GT(value("kerf_session_bytes"), 4096);
}

TEST_F(MetricsTest, CpuTimeIsCountedPerPresentParticipant) {
  const auto session = start();
  const auto ada = join(*session), ben = join(*session, "Ben");
  carve_circle(*session, ada, 100);
  const auto costs = session->cpu_costs();
  ASSERT_TRUE(costs.contains(ada));
  EXPECT_GT(costs.at(ada), 0);
  EXPECT_FALSE(costs.contains(ben));
  EXPECT_TRUE(metrics.text(*registry).contains("kerf_participant_cpu_seconds_total{participant=\"" +
                                               std::to_string(ada) + "\",session=\"block\"}"));
  session->leave(ada);
  EXPECT_TRUE(session->cpu_costs().empty());
}

TEST_F(MetricsTest, SortsTurnaroundsIntoBuckets) {
  metrics.motion_answered(80e-6);
  EXPECT_TRUE(has_line("kerf_turnaround_seconds_bucket{le=\"5e-05\"} 0"));
  EXPECT_TRUE(has_line("kerf_turnaround_seconds_bucket{le=\"0.0001\"} 1"));
}

}  // namespace
}  // namespace kerf::net::metrics_test
