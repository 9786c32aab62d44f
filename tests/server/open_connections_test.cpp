// SPDX-License-Identifier: Apache-2.0
#include "server/http/open_connections.h"

#include "tests/support/test.h"

namespace kerf::net::open_connections_test {
namespace {

class OpenConnectionsTest : public ::testing::Test {
 protected:
  OpenConnections::Place enter(const std::string& network, int number) {
    return open_.enter(network, [this, number] { closed_.push_back(number); });
  }
  OpenConnections open_;
  std::vector<int> closed_;
};

TEST_F(OpenConnectionsTest, OldestConnectionOfTheBusiestNetworkIsClosed) {
  EXPECT_FALSE(open_.close_one());
  const auto only = enter("10.0.0.1", 1);
  std::vector<OpenConnections::Place> many;
  for (int n = 2; n <= 4; ++n) many.push_back(enter("10.0.0.2", n));
  EXPECT_TRUE(open_.close_one());
  EXPECT_TRUE(open_.close_one());
  EXPECT_EQ(closed_, (std::vector{2, 3}));
}

TEST_F(OpenConnectionsTest, ClosedAndDepartedConnectionsDoNotCount) {
  auto first = enter("10.0.0.1", 1), second = enter("10.0.0.1", 2), third = enter("10.0.0.1", 3);
  const auto other = enter("10.0.0.2", 4), another = enter("10.0.0.2", 5);
  EXPECT_TRUE(open_.close_one());  // the first
  second.leave();
  second.leave();  // without effect
  EXPECT_TRUE(open_.close_one());
  EXPECT_EQ(closed_, (std::vector{1, 4}));
  first.leave();
  EXPECT_TRUE(open_.close_one());
  EXPECT_TRUE(open_.close_one());
  EXPECT_FALSE(open_.close_one()) << "all are closed";
  EXPECT_EQ(closed_.size(), 4U);
}

TEST_F(OpenConnectionsTest, MovedPlaceIsLeftOnce) {
  {
    auto place = enter("10.0.0.1", 1);
    const auto moved = std::move(place);
    EXPECT_TRUE(open_.close_one());
  }
  EXPECT_FALSE(open_.close_one());
}

}  // namespace
}  // namespace kerf::net::open_connections_test
