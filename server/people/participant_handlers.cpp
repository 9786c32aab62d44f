// SPDX-License-Identifier: Apache-2.0
#include "server/people/participant_handlers.h"

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "server/http/api_services.h"
#include "server/http/number.h"
#include "server/http/responses.h"
#include "server/rights/access.h"
#include "server/session/session.h"
#include "server/store/journal_people.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kReasonBytesMax = 200;

ApiResponse no_person() {
  return error_response(409, "no_person",
                        "this participant came without a personal invitation or a pass, so its "
                        "role cannot be kept; invite the person by name");
}

/// Mutes or unmutes a participant; a person also on its other and later connections.
AccessResult<void> mute(const ApiCall& call, ParticipantId id, const std::string& person,
                        bool muted) {
  Session& session = *call.session;
  std::vector<std::string> people;
  if (!person.empty()) {
    auto changed = call.services.access.set_muted(person, muted);
    if (!changed) return std::unexpected(changed.error());
    people = *std::move(changed);
  }
  run_and_wait(session.executor(), [&] {
    for (const std::string& one : people) session.people().set_muted_of(one, muted);
    return session.people().set_muted(id, muted);
  });
  return {};
}

}  // namespace

ApiResponse change_participant(const ApiCall& call) {
  Session& session = *call.session;
  const auto target = find_participant(session, call.captured);
  if (!target) return no_participant(call.captured);
  const ParticipantId id = target->participant.id;
  const std::string* muted = call.request.query_value("muted");
  const std::string* transfer = call.request.query_value("transfer");
  const bool transfers = transfer != nullptr && *transfer == "1";
  const std::string* role_text = call.request.query_value("role");
  const auto role =
      transfers ? std::optional(Role::kOwner) : parse_role(role_text == nullptr ? "" : *role_text);
  if (role_text != nullptr && !role) {
    return error_response(400, "bad_role", "role must be watcher, sculptor or owner");
  }
  const bool keeps_own = transfers && call.caller.role == Role::kOwner;
  if (role && (target->person.empty() || (keeps_own && !call.caller.is_personal))) {
    return no_person();
  }
  if (muted != nullptr) {
    if (auto done = mute(call, id, target->person, *muted == "1"); !done) {
      return error_response(done.error());
    }
  }
  if (role) {
    auto changed = call.services.access.set_role(target->person, *role);
    if (!changed) return error_response(changed.error());
    std::vector<std::string> lowered;
    if (keeps_own && call.services.access.root_of(call.caller.grant) !=
                         call.services.access.root_of(target->person)) {
      auto done = call.services.access.step_down(call.caller.grant, Role::kSculptor);
      if (!done) return error_response(done.error());
      lowered = *std::move(done);
    }
    run_and_wait(session.executor(), [&] {
      for (const std::string& person : lowered)
        session.people().set_role_of(person, Role::kSculptor);
      for (const std::string& person : *changed) session.people().set_role_of(person, *role);
      return true;
    });
  }
  (void)session.flush();
  return json_response(200, Json{{"participant", id}}.dump());
}

ApiResponse remove_participant(const ApiCall& call) {
  Session& session = *call.session;
  const auto target = find_participant(session, call.captured);
  if (!target) return no_participant(call.captured);
  const std::string* given = call.request.query_value("reason");
  const std::string reason = given == nullptr || given->empty() ? "an owner has removed you"
                                                                : given->substr(0, kReasonBytesMax);
  std::vector<std::string> grants;
  if (!target->person.empty()) {
    auto ended =
        call.services.access.revoke(session.id(), call.services.access.root_of(target->person));
    if (!ended) return error_response(ended.error());
    grants = *std::move(ended);
  }
  (void)session.flush();
  const bool removed = run_and_wait(session.executor(), [&] {
    const bool done = session.people().remove(target->participant.id, reason);
    session.remove_holders(grants, reason);
    return done;
  });
  if (!removed) {
    return error_response(409, "is_program", "a program is cancelled, not removed");
  }
  return json_response(200, Json{{"removed", target->participant.id}}.dump());
}

std::optional<FoundParticipant> find_participant(Session& session, const std::string& number) {
  const auto id = parse_number<ParticipantId>(number);
  if (!id) return std::nullopt;
  return run_and_wait(session.executor(), [&]() -> std::optional<FoundParticipant> {
    const auto participant = session.people().participant(*id);
    if (!participant) return std::nullopt;
    return FoundParticipant{*participant, session.people().person(*id)};
  });
}

ApiResponse no_participant(const std::string& number) {
  return error_response(404, "unknown_participant",
                        "no participant " + number + " is in the session");
}

ApiResponse list_authors(const ApiCall& call) {
  if (const auto flushed = call.session->flush(); !flushed) {
    return error_response(503, "busy", describe(flushed.error()));
  }
  const auto people = people_of(call.session->journal_file());
  if (!people) {
    return history_failure(*call.session, describe(people.error()), call.request.stop);
  }
  Json list = Json::array();
  for (const JournalParticipant& person : *people) {
    list.push_back({{"participant", person.participant},
                    {"name", person.name},
                    {"color", person.color},
                    {"kind", person.kind}});
  }
  return json_response(
      200, Json{{"authors", list}}.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace kerf::net
