// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "server/history/record_source.h"

namespace kerf {

/// Returns the committed records of a journal's file, which may have a concurrent writer.
std::unique_ptr<RecordSource> journal_records(std::filesystem::path journal);

}  // namespace kerf
