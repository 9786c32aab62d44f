// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <minizip/zip.h>
#include <unistd.h>

#include "tests/support/model_files.h"
#include "tests/support/test.h"

namespace kerf::test {

/// Returns a ZIP archive of parts, by name.
inline std::string zip_of(const std::map<std::string, std::string>& parts) {
  const auto path =
      std::filesystem::path(testing::TempDir()) / ("kerf-zip-" + std::to_string(::getpid()));
  const zipFile zip = zipOpen(path.c_str(), APPEND_STATUS_CREATE);
  for (const auto& [name, text] : parts) {
    const zip_fileinfo info{};
    EXPECT_EQ(zipOpenNewFileInZip(zip, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr,
                                  Z_DEFLATED, Z_DEFAULT_COMPRESSION),
              ZIP_OK);
    EXPECT_EQ(zipWriteInFileInZip(zip, text.data(), static_cast<unsigned>(text.size())), ZIP_OK);
    zipCloseFileInZip(zip);
  }
  zipClose(zip, nullptr);
  std::string bytes = content_of(path);
  std::filesystem::remove(path);
  return bytes;
}

}  // namespace kerf::test
