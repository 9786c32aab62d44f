// SPDX-License-Identifier: Apache-2.0
// Rights and the data of matters as attachments of a session's journal, with which they move to
// another server.
#include <algorithm>

#include "server/http/api.h"
#include "server/rights/rights_rows.h"
#include "server/store/attachment.h"

namespace kerf::net {
namespace {

/// Marks a journal whose attachments are complete.
constexpr const char* kCompleteKind = "complete";

bool is_complete(const std::vector<Attachment>& attachments) {
  return std::ranges::find(attachments, kCompleteKind, &Attachment::kind) != attachments.end();
}

}  // namespace

void Api::forget(const std::string& id) {
  // Grants left in the file are replaced when the session comes again.
  (void)access_.forget(id);
  services_.stores.forget(id);
}

void Api::attach_all(Session& session) {
  for (AttachmentChange& change : access_.attachments(session.id())) {
    session.attach(std::move(change));
  }
  services_.stores.attach_all(session);
  session.attach({kCompleteKind, "", std::vector<std::byte>()});
}

std::expected<void, std::string> Api::adopt(Session& session, Opening opening) {
  const std::string& id = session.id();
  // An earlier session with this id may have ended at another server.
  if (opening == Opening::kNew) forget(id);
  const auto attachments = read_attachments(session.journal_file());
  if (!attachments) return std::unexpected(describe(attachments.error()));
  // The journal predates attachments or was closed: attach the data that this server has.
  if (!is_complete(*attachments)) {
    attach_all(session);
    return {};
  }
  const auto ended = access_.adopt(id, *attachments);
  if (!ended) return std::unexpected(ended.error().reason);
  if (opening == Opening::kFollowed) {
    session.executor().post([self = session.shared_from_this(), ended = *ended] {
      self->remove_holders(ended, "the invitation was revoked");
    });
    return {};
  }
  const auto grants = access_.grants(id);
  for (const Attachment& attachment : *attachments) {
    const bool is_grant = attachment.kind == kGrantKind;
    if (is_grant && std::ranges::find(grants, attachment.name, &Grant::id) == grants.end()) {
      session.attach({kGrantKind, attachment.name});  // it has expired
    }
  }
  return services_.stores.adopt(session, *attachments);
}

}  // namespace kerf::net
