// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "server/session/past_source.h"

namespace kerf {

class Session;

/// Returns the past of a session: its committed records and its history. Use it on a thread that
/// serves nobody. Never waits for the session's thread.
std::unique_ptr<PastSource> past_of(std::shared_ptr<Session> session);

}  // namespace kerf
