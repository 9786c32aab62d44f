// SPDX-License-Identifier: Apache-2.0
#include "server/store/folder_lock.h"

#include <unistd.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::folder_lock_test {
namespace {

TEST(FolderLock, IsHeldByOneAtATimeAndNamesItsProcess) {
  const test::TemporaryFolder folder;
  {
    const auto first = FolderLock::take(folder.path());
    ASSERT_TRUE(first) << first.error();
    const auto error = test::error_of(FolderLock::take(folder.path()));
    EXPECT_NE(error.find("process " + std::to_string(getpid())), std::string::npos) << error;
  }
  auto again = FolderLock::take(folder.path());
  ASSERT_TRUE(again) << "the file remains, the lock does not";
  FolderLock moved = *std::move(again);
  EXPECT_FALSE(FolderLock::take(folder.path()));
}

TEST(FolderLock, MissingFolderIsAnError) {
  const test::TemporaryFolder folder;
  const auto error = test::error_of(FolderLock::take(folder / "nothing"));
  EXPECT_NE(error.find("No such file"), std::string::npos) << error;
}

/// Switches to an ordinary user, to whom permissions apply, unlike root.
class OrdinaryUser {
 public:
  static constexpr uid_t kNobody = 65534;
  OrdinaryUser() {
    if (user_ == 0 && seteuid(kNobody) != 0) ADD_FAILURE() << "seteuid";
  }
  ~OrdinaryUser() {
    if (user_ == 0 && seteuid(0) != 0) ADD_FAILURE() << "seteuid";
  }

 private:
  uid_t user_ = geteuid();
};

TEST(FolderLock, UnwritableFolderErrorNamesItsOwner) {
  const test::TemporaryFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0777));
  {
    ASSERT_TRUE(FolderLock::take(folder.path()));
  }  // the lock file exists and may be opened
  std::filesystem::permissions(folder / FolderLock::kFileName, std::filesystem::perms(0666));
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0555));
  const std::string owner = "belongs to uid " + std::to_string(geteuid());
  const OrdinaryUser user;
  const auto error = test::error_of(FolderLock::take(folder.path()));
  EXPECT_NE(error.find(owner), std::string::npos) << error;
  EXPECT_NE(error.find("make uid " + std::to_string(geteuid())), std::string::npos);
}

}  // namespace
}  // namespace kerf::folder_lock_test
