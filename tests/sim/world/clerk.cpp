// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/clerk.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "tests/sim/world/scene.h"

namespace kerf::sim {
namespace {

using Json = nlohmann::json;

std::string pin_name(std::uint32_t number, const std::string& text) {
  return "pin " + std::to_string(number) + " \"" + text + "\"";
}
std::string stroke_name(std::uint64_t id) { return "undo of stroke " + std::to_string(id); }

/// The port of an address "http://HOST:PORT/..."; 0: it is none.
int port_in(const std::string& location) {
  const std::size_t host = location.find("://");
  const std::size_t colon = host == std::string::npos ? host : location.find(':', host + 3);
  return colon == std::string::npos ? 0 : std::atoi(location.c_str() + colon + 1);
}

/// Whether a server may answer so to a request that is a good one.
bool is_allowed(const HttpAnswer& answer) {
  constexpr std::array kAllowed = {0, 200, 201, 202, 307, 404, 409, 429, 503, 507};
  return std::ranges::find(kAllowed, answer.status) != kAllowed.end();
}

}  // namespace

Clerk::Clerk(std::string session, std::vector<int> ports, std::uint64_t seed)
    : session_(std::move(session)),
      branch_prefix_("b" + std::to_string(seed) + "x"),
      ports_(std::move(ports)),
      random_(seed | 1) {}

std::uint64_t Clerk::draw_own(std::uint64_t below) {
  random_ = random_ * 6364136223846793005 + 1442695040888963407;
  return (random_ >> 33) % below;
}

HttpAnswer Clerk::request(const std::string& method, const std::string& rest, Time patience,
                          const std::string& body) {
  return request_at(method, "/v1/sessions/" + session_ + rest, patience, body);
}

/// Asks the server that has answered last, then where it leads; the next one if it is silent.
HttpAnswer Clerk::request_at(const std::string& method, const std::string& target, Time patience,
                             const std::string& body) {
  ++requests_;
  int port = ports_[place_];
  for (int hop = 0; hop < 3; ++hop) {
    const HttpAnswer answer = ask(port, method, target, body, patience, kAsAdmin);
    if (answer.status == 0) place_ = (place_ + 1) % ports_.size();
    if (!is_allowed(answer)) {
      wrong_.push_back(method + " " + target + ": " + std::to_string(answer.status) + " " +
                       answer.body);
    }
    const auto next = std::ranges::find(ports_, port_in(answer.location));
    if (answer.status != 307 || next == ports_.end()) return answer;
    place_ = static_cast<std::size_t>(next - ports_.begin());
    port = *next;
  }
  return {};
}

void Clerk::set_pin() {
  const std::string text = "p" + std::to_string(++made_);
  const auto answer =
      request("POST", "/pins?text=" + text + "&at_mm=1,2,-1&normal=0,0,1", 5 * kSecond);
  if (answer.status != 201) return;
  const auto number = Json::parse(answer.body).at("pin").get<std::uint32_t>();
  pins_.push_back(number);
  names_.push_back(text);
  promises_.promise(pin_name(number, text), true);
}

void Clerk::remove_pin() {
  if (pins_.empty()) return;
  const std::size_t chosen = draw_own(pins_.size());
  const std::uint32_t number = pins_[chosen];
  const std::string name = pin_name(number, names_[chosen]);
  promises_.ask(name);
  const auto answer = request("DELETE", "/pins/" + std::to_string(number), 5 * kSecond);
  pins_.erase(pins_.begin() + static_cast<std::ptrdiff_t>(chosen));
  names_.erase(names_.begin() + static_cast<std::ptrdiff_t>(chosen));
  if (answer.status == 200) promises_.promise(name, false);
}

void Clerk::name_version() {
  const std::string name = "v" + std::to_string(draw_own(6));
  const auto answer = request("POST", "/versions?name=" + name, 5 * kSecond);
  if (answer.status == 201) promises_.promise("version " + name, true);
  if (answer.status == 0 || answer.status >= 500) promises_.ask("version " + name);
}

void Clerk::remove_version() {
  const std::string name = "v" + std::to_string(draw_own(6));
  const auto answer = request("DELETE", "/versions/" + name, 5 * kSecond);
  if (answer.status == 200) promises_.promise("version " + name, false);
  if (answer.status == 0 || answer.status >= 500) promises_.ask("version " + name);
}

/// Undoes or redoes up to five strokes in one request.
void Clerk::change_strokes() {
  const auto listed = request("GET", "/strokes", 5 * kSecond);
  if (listed.status != 200) return;
  const Json answer = Json::parse(listed.body);
  const Json& strokes = answer.at("strokes");
  if (strokes.empty()) return;
  const bool undo = draw_own(3) != 0;
  std::vector<std::string> names;
  std::string numbers;
  for (std::size_t n = draw_own(strokes.size()); n < strokes.size() && names.size() < 5; ++n) {
    const Json& stroke = strokes[n];
    if (stroke.at("undone").get<bool>() == undo) continue;
    const auto id = stroke.at("id").get<std::uint64_t>();
    names.push_back(stroke_name(id));
    numbers += (numbers.empty() ? "" : ",") + std::to_string(id);
  }
  if (names.empty()) return;
  promises_.ask(names);
  stroke_changes_ += names.size();
  const auto changed =
      request("POST", std::string(undo ? "/undo" : "/redo") + "?strokes=" + numbers, 10 * kSecond);
  // 202: it is in the journal, and the block gets it later.
  if (changed.status != 200 && changed.status != 202) return;
  for (const std::string& name : names) promises_.promise(name, undo);
}

/// A program that crosses the block to and fro.
void Clerk::run_program() {
  std::string text = "G21 G90 G17 G94\nT2 M6\nG0 X-15 Y14 Z5\nG1 Z-2 F6000\n";
  for (std::uint64_t n = 10 + draw_own(100); n > 0; --n) {
    text += "G1 X" + std::to_string(n % 2 == 0 ? -15 : 15) + " Y" +
            std::to_string(14.0 - 0.01 * static_cast<double>(n)) + "\n";
  }
  const std::string name = "job" + std::to_string(++made_) + ".ngc";
  (void)request("POST", "/programs?pace=fast&name=" + name, 5 * kSecond, text + "M2\n");
}

void Clerk::make_branch() {
  const std::string id = branch_prefix_ + std::to_string(++made_);
  promises_.ask("session " + id);
  const auto answer =
      request_at("POST", "/v1/sessions?here=1&from=" + session_ + "&id=" + id, 10 * kSecond);
  branches_.push_back(id);
  if (answer.status == 201) promises_.promise("session " + id, true);
}

void Clerk::close_branch() {
  if (branches_.empty()) return;
  const std::string& id = branches_[draw_own(branches_.size())];
  promises_.ask("session " + id);
  const auto answer = request_at("DELETE", "/v1/sessions/" + id, 10 * kSecond);
  if (answer.status == 200) promises_.promise("session " + id, false);
}

void Clerk::reopen_branch() {
  const auto listed = request_at("GET", "/v1/closed", 5 * kSecond);
  if (listed.status != 200) return;
  const Json closed = Json::parse(listed.body).at("closed");
  if (closed.empty()) return;
  const Json& one = closed[draw_own(closed.size())];
  const auto id = one.at("id").get<std::string>();
  promises_.ask("session " + id);
  const auto answer =
      request_at("POST", "/v1/closed/" + one.at("name").get<std::string>(), 10 * kSecond);
  if (answer.status == 201) promises_.promise("session " + id, true);
}

void Clerk::download() {
  constexpr std::array kFiles = {"/model.stl", "/program.ngc", "/forces.csv", "/strokes",
                                 "/authors",   "/versions",    "/pins",       "/replay",
                                 "/exports",   "/programs",    "/model.glb",  ""};
  (void)request("GET", kFiles[draw_own(kFiles.size())], 5 * kSecond);
}

void Clerk::act() {
  switch (draw_own(17)) {
    case 0:
    case 1:
    case 2:
      return set_pin();
    case 3:
      return remove_pin();
    case 4:
    case 5:
      return name_version();
    case 6:
      return remove_version();
    case 7:
    case 8:
    case 9:
      return change_strokes();
    case 10:
      return run_program();
    case 11:
    case 12:
      return make_branch();
    case 13:
      return close_branch();
    case 14:
      return reopen_branch();
    default:
      return download();
  }
}

void Clerk::start(Time end, Time pause_max) {
  thread_ = std::thread([this, end, pause_max] {
    while (now() < end) {
      act();
      const auto pause = draw_own(static_cast<std::uint64_t>(pause_max));
      std::this_thread::sleep_for(std::chrono::nanoseconds(pause));
    }
  });
}

bool Clerk::read(std::map<std::string, bool>& present, Time patience) {
  const Time end = now() + patience;
  while (now() < end) {
    const auto pins = request("GET", "/pins", patience);
    const auto versions = request("GET", "/versions", patience);
    const auto strokes = request("GET", "/strokes", patience);
    if (pins.status == 200 && versions.status == 200 && strokes.status == 200) {
      const Json pin_list = Json::parse(pins.body), version_list = Json::parse(versions.body),
                 stroke_list = Json::parse(strokes.body);
      for (const Json& pin : pin_list.at("pins")) {
        present[pin_name(pin.at("pin"), pin.at("text"))] = true;
      }
      for (const Json& version : version_list.at("versions")) {
        present["version " + version.at("name").get<std::string>()] = true;
      }
      for (const Json& stroke : stroke_list.at("strokes")) {
        present[stroke_name(stroke.at("id"))] = stroke.at("undone").get<bool>();
      }
      bool is_whole = true;
      for (const std::string& id : branches_) {
        const int status = request_at("GET", "/v1/sessions/" + id, patience).status;
        present["session " + id] = status == 200;
        is_whole = is_whole && (status == 200 || status == 404);
      }
      if (is_whole) return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return false;
}

}  // namespace kerf::sim
