// SPDX-License-Identifier: Apache-2.0
#include "server/programs/program_store.h"

#include <utility>
#include <vector>

#include "server/http/api_services.h"
#include "server/session/session.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {

std::unique_ptr<MatterStore> ProgramStore::make(ApiServices& services) {
  return std::make_unique<ProgramStore>(services.registry);
}

std::expected<void, std::string> ProgramStore::adopt(Session& session,
                                                     std::span<const Attachment> attachments) {
  // Requests that find the session are posted after this.
  std::vector<Attachment> list(attachments.begin(), attachments.end());
  session.executor().post([weak = session.weak_from_this(), list = std::move(list)] {
    if (const auto self = weak.lock()) self->programs().list_stopped(list);
  });
  return {};
}

void ProgramStore::free_memory() {
  for (const auto& session : registry_.list()) {
    run_and_wait(session->executor(), [&] { return session->programs().drop_ended_texts(), 0; });
  }
}

}  // namespace kerf::net
