// SPDX-License-Identifier: Apache-2.0
#include "server/store/folder_lock.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/server/temporary_folder.h"

namespace kerf {
namespace {

TEST(FolderLock, IsHeldByOneAtATimeAndNamesItsProcess) {
  const test::TemporaryFolder folder;
  {
    const auto first = FolderLock::take(folder.path());
    ASSERT_TRUE(first) << first.error();
    const auto second = FolderLock::take(folder.path());
    ASSERT_FALSE(second);
    EXPECT_NE(second.error().find("process " + std::to_string(getpid())), std::string::npos)
        << second.error();
  }
  auto again = FolderLock::take(folder.path());
  ASSERT_TRUE(again) << "the file remains, the lock does not";
  FolderLock moved = *std::move(again);
  EXPECT_FALSE(FolderLock::take(folder.path()));
}

TEST(FolderLock, OfAMissingFolderIsAnError) {
  const test::TemporaryFolder folder;
  const auto lock = FolderLock::take(folder / "nothing");
  ASSERT_FALSE(lock);
  EXPECT_NE(lock.error().find("cannot open"), std::string::npos);
}

}  // namespace
}  // namespace kerf
