// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <optional>
#include <string>

#include "server/cluster/copies.h"
#include "server/cluster/nats_connection.h"

namespace kerf {

/// The epoch of the last message of a session's copy, or 0 without a copy. The error is one
/// sentence.
std::expected<std::uint32_t, std::string> epoch_of_copy(NatsConnection& nats,
                                                        const std::string& session);

/// Makes `file` the journal with which the server that has the lease continues a session in
/// `epoch`. From then on no server of an earlier epoch can add to the copy. An existing journal
/// with all records of the copy stays if its non-record data is as new: `is_current` (it followed
/// the copy until now), it has more records, or no later epoch has added to the copy. Otherwise the
/// copy replaces it, and it is moved to the folder `kept` if it has something that the copy lacks.
/// The error is one sentence.
std::expected<void, std::string> prepare_journal(NatsConnection& nats, const std::string& session,
                                                 std::uint32_t epoch,
                                                 const std::filesystem::path& file,
                                                 const std::filesystem::path& kept,
                                                 bool is_current = false);

/// Makes `file` a copy of the journal of a session that another server runs, in its present state,
/// and returns where it ends. An existing journal is moved as above. The error is one sentence.
std::expected<FetchedCopy, std::string> prepare_following(NatsConnection& nats,
                                                          const std::string& session,
                                                          const std::filesystem::path& file,
                                                          const std::filesystem::path& kept);

}  // namespace kerf
