// SPDX-License-Identifier: Apache-2.0
// Rights and target parts as attachments of a session's journal, with which they move to another
// server.
#include <algorithm>
#include <set>

#include "server/http/api.h"
#include "server/rights/rights_rows.h"
#include "server/store/attachment.h"

namespace kerf::net {
namespace {

constexpr const char* kTargetKind = "target";
/// Marks a journal whose attachments are complete.
constexpr const char* kCompleteKind = "complete";

bool is_complete(const std::vector<Attachment>& attachments) {
  return std::ranges::find(attachments, kCompleteKind, &Attachment::kind) != attachments.end();
}

}  // namespace

void Api::forget(const std::string& id) {
  // Grants left in the file are replaced when the session comes again.
  (void)access_.forget(id);
  targets_.forget(id);
}

void Api::attach_all(Session& session) {
  for (AttachmentChange& change : access_.attachments(session.id())) {
    session.attach(std::move(change));
  }
  for (const TargetFacts& facts : targets_.list(session.id())) attach_target(session, facts.name);
  session.attach({kCompleteKind, "", std::vector<std::byte>()});
}

void Api::attach_target(Session& session, const std::string& name) {
  const std::lock_guard lock(attach_mutex_);
  session.attach({kTargetKind, name, targets_.pack(session.id(), name)});
}

std::expected<void, std::string> Api::adopt(Session& session, Opening opening) {
  const std::string& id = session.id();
  // An earlier session with this id may have ended at another server.
  if (opening == Opening::kNew) forget(id);
  auto attachments = read_attachments(session.journal_file());
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
  if (auto done = adopt_targets(id, *attachments); !done) return done;
  // Requests that find the session are posted after this.
  session.executor().post([weak = session.weak_from_this(), list = *std::move(attachments)] {
    if (const auto self = weak.lock()) self->list_stopped(list);
  });
  return {};
}

std::expected<void, std::string> Api::adopt_targets(const std::string& id,
                                                    const std::vector<Attachment>& attachments) {
  std::set<std::string> attached;
  for (const Attachment& attachment : attachments) {
    if (attachment.kind != kTargetKind) continue;
    attached.insert(attachment.name);
    if (!targets_.unpack(id, attachment.bytes)) {
      return std::unexpected("target part " + attachment.name + " of session " + id +
                             " cannot be stored");
    }
  }
  for (const TargetFacts& facts : targets_.list(id)) {
    if (!attached.contains(facts.name)) targets_.remove(id, facts.name);
  }
  return {};
}

}  // namespace kerf::net
