// SPDX-License-Identifier: Apache-2.0
#include "server/http/matter_stores.h"

namespace kerf::net {

MatterStores::MatterStores(std::span<const HttpMatter> matters, ApiServices& services) {
  for (const HttpMatter& matter : matters) {
    if (matter.make_store != nullptr) stores_.push_back(matter.make_store(services));
  }
}

void MatterStores::attach_all(Session& session) {
  for (const auto& store : stores_) store->attach_all(session);
}

std::expected<void, std::string> MatterStores::adopt(Session& session,
                                                     std::span<const Attachment> attachments) {
  for (const auto& store : stores_) {
    if (auto adopted = store->adopt(session, attachments); !adopted) return adopted;
  }
  return {};
}

void MatterStores::forget(const std::string& session) {
  for (const auto& store : stores_) store->forget(session);
}

void MatterStores::free_memory() {
  for (const auto& store : stores_) store->free_memory();
}

void MatterStores::stop() {
  for (const auto& store : stores_) store->stop();
}

}  // namespace kerf::net
