// SPDX-License-Identifier: Apache-2.0
// Which uploaded files of which owner are kept.
#include "server/http/upload_folder.h"

#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::net::upload_folder_test {
namespace {

namespace fs = std::filesystem;

class Uploads : public ::testing::Test {
 protected:
  /// Stores a file with an older date than all later ones.
  std::string keep(const std::string& owner, const std::string& bytes) {
    const std::string name = uploads_.keep(owner, ".stl", bytes);
    EXPECT_FALSE(name.empty());
    for (const auto& entry : fs::recursive_directory_iterator(path_)) {
      if (entry.path().filename() != name) continue;
      fs::last_write_time(entry.path(), start_ + std::chrono::seconds(++stored_));
    }
    return name;
  }
  bool is_kept(const std::string& name) const {
    return uploads_.named_in("{\"file\":\"" + name + "\"}").contains(name);
  }
  std::size_t files() const {
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(path_)) {
      count += entry.is_regular_file() ? 1 : 0;
    }
    return count;
  }

  test::TemporaryFolder folder_;
  fs::path path_ = folder_.path() / "uploads";
  fs::file_time_type start_ = fs::file_time_type::clock::now() - std::chrono::hours(1);
  int stored_ = 0;
  UploadFolder uploads_{path_, {.files_of_owner = 3, .files = 6, .bytes = 100}};
};

TEST_F(Uploads, AreFoundByTheirNamesInQuotes) {
  const std::string a = keep("ada", "solid a"), b = keep("bo", "solid b");
  EXPECT_EQ(a.substr(16), ".stl");
  EXPECT_EQ(keep("bo", "solid a"), a) << "equal files have equal names";
  const auto named = uploads_.named_in("[\"" + a + "\", " + b + "]");
  EXPECT_EQ(named, (std::map<std::string, std::string>{{a, "solid a"}}));
}

TEST_F(Uploads, DoNotDeleteFilesOfOtherOwners) {
  const std::string mine = keep("ada", "mine");
  std::vector<std::string> theirs;
  for (int n = 0; n < 9; ++n) theirs.push_back(keep("bo", "theirs " + std::to_string(n)));
  EXPECT_TRUE(is_kept(mine));
  for (std::size_t n = 0; n < theirs.size(); ++n) EXPECT_EQ(is_kept(theirs[n]), n >= 6) << n;
}

TEST_F(Uploads, LargestOwnerLosesItsOldestAboveTheByteLimit) {
  const std::string mine = keep("ada", std::string(20, 'a'));
  const std::string old = keep("bo", std::string(40, 'b')),
                    other = keep("bo", std::string(30, 'c'));
  EXPECT_TRUE(is_kept(mine) && is_kept(old) && is_kept(other));
  const std::string newest = keep("cy", std::string(25, 'd'));
  EXPECT_FALSE(is_kept(old));
  EXPECT_TRUE(is_kept(mine) && is_kept(other) && is_kept(newest));
}

TEST_F(Uploads, LargestOwnerLosesItsOldestAboveTheFileLimit) {
  const std::string mine = keep("ada", std::string(60, 'a'));
  for (int n = 0; n < 3; ++n) keep("bo", "b" + std::to_string(n));
  for (int n = 0; n < 3; ++n) keep("cy", "c" + std::to_string(n));
  EXPECT_TRUE(is_kept(mine)) << "though it is the largest";
  EXPECT_EQ(files(), 6U);
}

TEST_F(Uploads, JustStoredFileIsKeptEvenOfTheLargestOwner) {
  for (const char* owner : {"ada", "bo", "cy"}) keep(owner, std::string(25, *owner));
  const std::string largest = keep("dee", std::string(50, 'd'));
  EXPECT_TRUE(is_kept(largest));
  EXPECT_EQ(files(), 3U) << "one of the others went";
}

TEST_F(Uploads, FileAboveTheLimitReplacesAll) {
  keep("ada", "a");
  keep("bo", "");
  EXPECT_TRUE(is_kept(keep("cy", std::string(101, 'c'))));
  EXPECT_EQ(files(), 1U);
}

TEST_F(Uploads, JustStoredFileIsKeptAfterTheClockWasSetBack) {
  start_ += std::chrono::hours(2);
  for (int n = 0; n < 3; ++n) keep("ada", "a" + std::to_string(n));
  start_ -= std::chrono::hours(3);
  EXPECT_TRUE(is_kept(keep("ada", "newest")));
  EXPECT_EQ(files(), 3U);
}

TEST_F(Uploads, AreFoundWhileOtherFoldersAreRemoved) {
  const std::string mine = keep("ada", "mine");
  std::atomic<bool> is_done = false;
  std::jthread others([&] {
    for (int n = 0; n < 300; ++n) {
      const std::string owner = std::to_string(n);
      uploads_.keep(owner, ".stl", std::string(30, 'x') + owner);  // deletes another's only file
    }
    is_done = true;
  });
  while (!is_done) EXPECT_TRUE(is_kept(mine));
}

TEST_F(Uploads, FilesOfOlderVersionsAreFound) {
  fs::create_directories(path_);
  std::ofstream(path_ / "0123456789abcdef.stl") << "solid";
  EXPECT_TRUE(is_kept("0123456789abcdef.stl"));
  for (int n = 0; n < 4; ++n) keep("bo", "b" + std::to_string(n));
  EXPECT_TRUE(is_kept("0123456789abcdef.stl"));
}

}  // namespace
}  // namespace kerf::net::upload_folder_test
