// SPDX-License-Identifier: Apache-2.0
#include "server/downloads/download_request.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "server/http/number.h"
#include "server/http/place.h"

namespace kerf::net {
namespace {

constexpr DownloadKind kMotionDownloads[] = {{"program.ngc", "text/plain", ".ngc"},
                                             {"program.apt", "text/plain", ".apt"},
                                             {"forces.csv", "text/csv", ".csv"},
                                             {"forces", "application/json", ".json"},
                                             {"thin_walls.json", "application/json", ".json"},
                                             {"journal", "application/vnd.sqlite3", ".kerf"}};
constexpr std::string_view kModel = "model.";

std::unexpected<Error> bad_request(const char* code, std::string reason) {
  return std::unexpected(Error{ErrorKind::kInvalid, code, std::move(reason)});
}

std::expected<void, Error> read_model(const ApiRequest& request, DownloadRequest& download) {
  const ModelFormat format = *download.model;
  download.encoding = model_encodings(format).front();
  if (const std::string* name = request.query_value("encoding")) {
    const auto encoding = model_encoding(format, *name);
    if (!encoding) {
      std::string known;
      for (const ModelEncoding one : model_encodings(format)) {
        known += (known.empty() ? "" : ", ") + std::string(to_string(one));
      }
      return bad_request("bad_encoding", "encoding must be one of: " + known);
    }
    if (*encoding != download.encoding) download.suffix += '-' + *name;
    download.encoding = *encoding;
  }
  if (const std::string* text = request.query_value("triangles")) {
    download.simplify.triangles = parse_number<std::uint64_t>(*text);
    if (download.simplify.triangles.value_or(0) == 0) {
      return bad_request("bad_triangles", "triangles must be an integer > 0");
    }
    download.suffix += '-' + *text + "-triangles";
  }
  if (const std::string* text = request.query_value("at")) {
    auto point = parse_point(*text);
    if (!point) return bad_request("bad_at", "at " + point.error());
    download.at = *std::move(point);
  }
  if (const std::string* text = request.query_value("shift_mm")) {
    const auto shift = parse_place(text);
    if (!shift) {
      return bad_request("bad_shift_mm", "shift_mm must be three numbers X,Y,Z of at most 1000000");
    }
    download.shift_mm = *shift;
    download.suffix += "-shifted-" + *text;
  }
  if (const std::string* text = request.query_value("error_mm")) {
    const double bound = parse_number<double>(*text).value_or(-1);
    if (!(bound >= 0) || !std::isfinite(bound)) {
      return bad_request("bad_error_mm", "error_mm must be a number >= 0");
    }
    if (bound > 0) download.simplify.error_mm = bound;
    download.is_exact = bound == 0;
    download.suffix += bound > 0 ? '-' + *text + "mm" : "-exact";
  }
  return {};
}

std::expected<void, Error> read_program(const ApiRequest& request, DownloadRequest& download) {
  ProgramRequest& program = download.program;
  if (std::string_view(download.kind.name) == "program.apt")
    program.style.format = ProgramFormat::kApt;
  if (const std::string* id = request.query_value("participant")) {
    program.only = parse_number<ParticipantId>(*id);
    if (!program.only) {
      return bad_request("bad_participant", "participant must be a participant number");
    }
    download.forces.only = program.only;
    download.suffix += "-p" + *id;
  }
  const auto record = [&](const char* name, std::uint64_t& value) {
    const std::string* text = request.query_value(name);
    if (text == nullptr) return true;
    const auto given = parse_number<std::uint64_t>(*text);
    value = given.value_or(0);
    download.suffix += std::string("-") + name + *text;
    return given.has_value();
  };
  if (!record("from", program.first) || !record("to", program.last)) {
    return bad_request("bad_span", "from and to must be journal record numbers");
  }
  const std::string* name = request.query_value("post");
  if (name != nullptr && program.style.format == ProgramFormat::kGcode) {
    const auto post = post_of(*name);
    if (!post) return bad_request("bad_post", "post must be one of " + post_names());
    program.style.post = *post;
    download.suffix += '-' + *name;
    if (*post == Post::kHeidenhain) download.kind.extension = ".h";
  }
  if (const std::string* text = request.query_value("tolerance_mm")) {
    program.style.tolerance_mm = parse_number<double>(*text).value_or(-1);
    if (!(program.style.tolerance_mm >= 0) || !std::isfinite(program.style.tolerance_mm)) {
      return bad_request("bad_tolerance_mm", "tolerance_mm must be a number >= 0");
    }
    download.suffix += '-' + *text + "mm";
  }
  return {};
}

/// Reads the parameters of a plot. Call after read_program().
std::expected<void, Error> read_plot(const ApiRequest& request, DownloadRequest& download) {
  const ProgramRequest& program = download.program;
  ForcePlotRequest& plot = download.plot;
  plot.only = program.only;
  plot.first = std::max<std::uint64_t>(program.first, 1);
  plot.last = program.last;
  if (program.first > program.last) return bad_request("bad_span", "from must not exceed to");
  const std::string* text = request.query_value("points");
  if (text == nullptr) return {};
  const auto points = parse_number<std::size_t>(*text);
  if (!points || *points < 1 || *points > kForcePointsMax) {
    return bad_request("bad_points",
                       "points must be an integer from 1 to " + std::to_string(kForcePointsMax));
  }
  plot.points = *points;
  download.suffix += "-" + *text + "-points";
  return {};
}

std::expected<void, Error> read_device(const ApiRequest& request, DownloadRequest& download) {
  const std::string* text = request.query_value("device_limits");
  if (text == nullptr) return {};
  const std::size_t comma = text->find(',');
  const auto limit = [&](std::size_t from, std::size_t to) {
    const auto value = parse_number<double>(text->substr(from, to));
    return value && *value > 0 && std::isfinite(*value) ? *value : 0;
  };
  const double force_n = comma == std::string::npos ? 0 : limit(0, comma);
  const double torque_nmm = comma == std::string::npos ? 0 : limit(comma + 1, text->npos);
  if (force_n == 0 || torque_nmm == 0) {
    return bad_request("bad_device_limits",
                       "device_limits must be two numbers > 0: FORCE_N,TORQUE_NMM");
  }
  download.forces.device = WrenchMaximum{force_n, torque_nmm};
  download.suffix += "-felt-" + text->substr(0, comma) + '-' + text->substr(comma + 1);
  return {};
}

}  // namespace

std::expected<DownloadRequest, Error> read_download_request(const ApiRequest& request) {
  const std::string& name = request.path[3];
  for (const DownloadKind& kind : kMotionDownloads) {
    if (name != kind.name) continue;
    DownloadRequest download;
    download.kind = kind;
    if (auto read = read_program(request, download); !read) return std::unexpected(read.error());
    if (auto read = read_device(request, download); !read) return std::unexpected(read.error());
    if (auto read = read_plot(request, download); !read && name == "forces") {
      return std::unexpected(read.error());
    }
    return download;
  }
  if (name.starts_with(kModel)) {
    if (const auto format = model_format(name.substr(kModel.size()))) {
      const char* extension = name.c_str() + kModel.size() - 1;
      DownloadRequest download;
      download.kind = {name.c_str(), media_type(*format), extension};
      download.model = format;
      if (auto read = read_model(request, download); !read) return std::unexpected(read.error());
      return download;
    }
  }
  return std::unexpected(Error{ErrorKind::kUnknown, "not_found", "there is no download " + name});
}

}  // namespace kerf::net
