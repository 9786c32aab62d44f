// SPDX-License-Identifier: Apache-2.0
// The part of the HTTP interface that hands out files made from a session.
#include <charconv>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "server/formats/model/model_writer.h"
#include "server/formats/model/simplify_mesh.h"
#include "server/http/api.h"
#include "server/http/download_name.h"
#include "server/session/hash_text.h"
#include "server/session/session_export.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

struct Download {
  const char* name;
  const char* content_type;
  const char* extension;
};
constexpr Download kOfMotions[] = {{"program.ngc", "text/plain", ".ngc"},
                                   {"program.apt", "text/plain", ".apt"},
                                   {"forces.csv", "text/csv", ".csv"},
                                   {"journal", "application/vnd.sqlite3", ".kerf"}};
constexpr std::string_view kModel = "model.";

/// What a request asks for.
struct Wanted {
  Download what;
  std::optional<ModelFormat> model;  ///< none: something that is made of motions
  ModelEncoding encoding = ModelEncoding::kBinary;
  SimplifyRequest simplify;
  ProgramRequest program;  ///< its participant is that of forces too
  std::string suffix;      ///< sets its name apart from that of the plain download
};
struct BadRequest {
  unsigned status;
  const char* code;
  std::string reason;
};

const std::string* query(const ApiRequest& request, const char* name) {
  const auto found = request.query.find(name);
  return found == request.query.end() ? nullptr : &found->second;
}

template <class T>
std::optional<T> number(const std::string& text) {
  T value{};
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end) return std::nullopt;
  return value;
}

std::expected<void, BadRequest> read_model(const ApiRequest& request, Wanted& wanted) {
  const ModelFormat format = *wanted.model;
  wanted.encoding = model_encodings(format).front();
  if (const std::string* name = query(request, "encoding")) {
    const auto encoding = model_encoding(format, *name);
    if (!encoding) {
      std::string known;
      for (const ModelEncoding one : model_encodings(format)) {
        known += (known.empty() ? "" : ", ") + std::string(to_string(one));
      }
      return std::unexpected(
          BadRequest{400, "bad_encoding", "the encodings of this format are: " + known});
    }
    if (*encoding != wanted.encoding) wanted.suffix += '-' + *name;
    wanted.encoding = *encoding;
  }
  if (const std::string* text = query(request, "triangles")) {
    wanted.simplify.triangles = number<std::uint64_t>(*text);
    if (wanted.simplify.triangles.value_or(0) == 0) {
      return std::unexpected(BadRequest{400, "bad_triangles", "triangles is no number above 0"});
    }
    wanted.suffix += '-' + *text + "-triangles";
  }
  if (const std::string* text = query(request, "error_mm")) {
    wanted.simplify.error_mm = number<double>(*text);
    const double bound = wanted.simplify.error_mm.value_or(0);
    if (!(bound > 0) || !std::isfinite(bound)) {
      return std::unexpected(BadRequest{400, "bad_error_mm", "error_mm is no number above 0"});
    }
    wanted.suffix += '-' + *text + "mm";
  }
  return {};
}

std::expected<void, BadRequest> read_program(const ApiRequest& request, Wanted& wanted) {
  ProgramRequest& program = wanted.program;
  if (std::string_view(wanted.what.name) == "program.apt") program.format = ProgramFormat::kApt;
  if (const std::string* who = query(request, "participant")) {
    program.only = number<ParticipantId>(*who);
    if (!program.only) {
      return std::unexpected(BadRequest{400, "bad_participant", "participant is not a number"});
    }
    wanted.suffix += "-p" + *who;
  }
  const auto record = [&](const char* name, std::uint64_t& value) {
    const std::string* text = query(request, name);
    if (text == nullptr) return true;
    const auto given = number<std::uint64_t>(*text);
    value = given.value_or(0);
    wanted.suffix += std::string("-") + name + *text;
    return given.has_value();
  };
  if (!record("from", program.first) || !record("to", program.last)) {
    return std::unexpected(BadRequest{400, "bad_span", "from and to are numbers of records"});
  }
  if (const std::string* text = query(request, "tolerance_mm")) {
    program.tolerance_mm = number<double>(*text).value_or(-1);
    if (!(program.tolerance_mm >= 0) || !std::isfinite(program.tolerance_mm)) {
      return std::unexpected(
          BadRequest{400, "bad_tolerance_mm", "tolerance_mm is no number from 0 on"});
    }
    wanted.suffix += '-' + *text + "mm";
  }
  return {};
}

std::expected<Wanted, BadRequest> read_wanted(const ApiRequest& request) {
  const std::string& name = request.path[3];
  for (const Download& what : kOfMotions) {
    if (name != what.name) continue;
    Wanted wanted;
    wanted.what = what;
    if (auto read = read_program(request, wanted); !read) return std::unexpected(read.error());
    return wanted;
  }
  if (name.starts_with(kModel)) {
    if (const auto format = model_format(name.substr(kModel.size()))) {
      const char* extension = name.c_str() + kModel.size() - 1;
      Wanted wanted;
      wanted.what = {name.c_str(), media_type(*format), extension};
      wanted.model = format;
      if (auto read = read_model(request, wanted); !read) return std::unexpected(read.error());
      return wanted;
    }
  }
  return std::unexpected(BadRequest{404, "not_found", "there is no download " + name});
}

using Made = std::expected<void, MakeError>;

template <typename Result>
Made reason_only(const Result& result) {
  if (!result) return std::unexpected(MakeError{result.error().reason});
  return {};
}

Made write_motions(const Wanted& wanted, Session& session, const std::filesystem::path& path) {
  if (auto ok = session.flush(); !ok) return std::unexpected(MakeError{describe(ok.error())});
  const std::string_view name = wanted.what.name;
  const auto& journal = session.journal_file();
  if (name == "journal") return reason_only(copy_journal(journal, path));
  std::ofstream out(path, std::ios::binary);
  if (!out) return std::unexpected(MakeError{"the file cannot be created"});
  const auto written = name == "forces.csv" ? export_forces(journal, wanted.program.only, out)
                                            : export_program(journal, wanted.program, out);
  if (!written) return std::unexpected(MakeError{written.error()});
  out.close();
  if (!out) return std::unexpected(MakeError{"the disk is full or broken"});
  return {};
}

/// Answers with the whole file, or the part of it that is asked for.
void put_file(const ApiRequest& request, const std::string& etag, ApiResponse& response) {
  const std::uint64_t bytes = response.file->bytes();
  response.headers.emplace_back("Accept-Ranges", "bytes");
  // A part of an older state would not fit to what the client holds.
  if (!request.if_range.empty() && request.if_range != etag) return;
  const auto range = parse_range(request.range, bytes);
  if (!range) {
    auto rejection =
        error_response(416, "bad_range", "the file has " + std::to_string(bytes) + " bytes");
    rejection.headers.emplace_back("Content-Range", "bytes */" + std::to_string(bytes));
    response = std::move(rejection);
    return;
  }
  if (!*range) return;
  response.status = 206;
  response.part = *range;
  const std::uint64_t last = (*range)->first + (*range)->count - 1;
  response.headers.emplace_back("Content-Range", "bytes " + std::to_string((*range)->first) + "-" +
                                                     std::to_string(last) + "/" +
                                                     std::to_string(bytes));
}

Made write_surface(const Wanted& wanted, const SolidSnapshot& snapshot, const std::string& title,
                   const std::filesystem::path& path, const DownloadCache::Progress& progress) {
  const ModelRequest request{
      .format = *wanted.model, .encoding = wanted.encoding, .title = title, .progress = progress};
  SnapshotMesh exact(snapshot);
  if (!wanted.simplify.triangles && !wanted.simplify.error_mm) {
    return reason_only(write_model(path, exact, request));
  }
  const auto simplified = simplify_mesh(exact, wanted.simplify, progress);
  if (!simplified) return std::unexpected(MakeError{simplified.error().reason, true});
  WholeMesh mesh(simplified->mesh);
  return reason_only(write_model(path, mesh, request));
}

bool is_same(const std::string& if_none_match, const std::string& etag) {
  return if_none_match == "*" || if_none_match.find(etag) != std::string::npos;
}

}  // namespace

ApiResponse Api::download(const ApiRequest& request, const SessionPtr& session) {
  const auto wanted = read_wanted(request);
  if (!wanted)
    return error_response(wanted.error().status, wanted.error().code, wanted.error().reason);
  if (request.method != "GET" && request.method != "HEAD") {
    auto response = error_response(405, "bad_method", request.method + " is not possible here");
    response.headers.emplace_back("Allow", "GET, HEAD");
    return response;
  }
  const Moment now = current_moment(*session);
  std::string tag = hash_text(now.hash.hash);
  // Different motions may leave the same solid, so what is made of motions is named by their number
  // too.
  if (!wanted->model) tag += "-" + std::to_string(now.hash.sequence);
  tag += wanted->suffix;
  const std::string etag = '"' + tag + '"';
  ApiResponse response;
  response.headers.emplace_back("ETag", etag);
  response.headers.emplace_back("Cache-Control", "no-cache");
  if (is_same(request.if_none_match, etag)) {
    response.status = 304;
    return response;
  }
  const auto file = downloads_.get(
      session->id() + "/" + request.path[3] + "/" + tag + "/" + std::to_string(session->epoch()),
      [&](const std::filesystem::path& path, const DownloadCache::Progress& progress) -> Made {
        if (!wanted->model) return write_motions(*wanted, *session, path);
        return write_surface(*wanted, now.solid, session->scene().name, path, progress);
      });
  if (!file) {
    const auto& [reason, impossible] = file.error();
    return impossible ? error_response(422, "budget_impossible", reason)
                      : error_response(500, "export_failed", reason);
  }
  response.file = *file;
  response.content_type = wanted->what.content_type;
  const std::string name =
      download_name(session->scene().name, session->id(), wanted->suffix, wanted->what.extension);
  response.headers.emplace_back("Content-Disposition", content_disposition(name));
  put_file(request, etag, response);
  return response;
}

ApiResponse Api::exports(const ApiRequest& request, const std::string& session_id) {
  if (request.method != "GET" && request.method != "HEAD") {
    auto response = error_response(405, "bad_method", request.method + " is not possible here");
    response.headers.emplace_back("Allow", "GET, HEAD");
    return response;
  }
  nlohmann::json list = nlohmann::json::array();
  const std::string prefix = session_id + "/";
  for (const auto& making : downloads_.making(prefix)) {
    const std::string rest = making.key.substr(prefix.size());
    list.push_back({{"name", rest.substr(0, rest.find('/'))},
                    {"share", std::round(making.share * 1000) / 1000},
                    {"seconds", std::round(making.seconds * 1000) / 1000}});
  }
  ApiResponse response;
  response.body = nlohmann::json{{"exports", list}}.dump() + "\n";
  return response;
}

}  // namespace kerf::net
