// SPDX-License-Identifier: Apache-2.0
// Answers of a server have the statuses, types, fields and error codes that it describes in
// /openapi.json, and no other fields.
#include <algorithm>
#include <ranges>
#include <string>
#include <vector>

#include "tests/formats/json_schema.h"
#include "tests/server/whole/hand.h"
#include "tests/server/whole/whole_server.h"

namespace kerf::test::described_answers_test {
namespace {

constexpr const char* kProgram =
    "G21 G90 G17 G94\nT2 M6\nG0 X-15 Y-15 Z5\nG1 Z-3 F600\nX15 F1200\nY15\nG0 Z5\nM2\n";
constexpr const char* kTetrahedron =
    "v 0 0 -9\nv 9 0 -9\nv 0 9 -9\nv 0 0 0\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// Forbids properties that a schema does not describe.
void close_objects(Json& value) {
  if (value.is_object() && value.contains("properties")) value["additionalProperties"] = false;
  if (!value.is_structured()) return;
  for (Json& member : value) close_objects(member);
}

/// Whether a path, without its query, fits a path of the document.
bool fits(const std::string& pattern, const std::string& path) {
  const auto segments = [](const std::string& text) {
    std::vector<std::string> parts;
    for (const auto part : std::views::split(text, '/'))
      parts.emplace_back(part.begin(), part.end());
    return parts;
  };
  return std::ranges::equal(
      segments(pattern), segments(path), [](const std::string& part, const std::string& text) {
        const auto brace = part.find('{');
        return brace == part.npos ? part == text : text.starts_with(part.substr(0, brace));
      });
}

class DescribedAnswers : public WholeServer {
 protected:
  void SetUp() override {
    WholeServer::SetUp();
    document_ = made("GET", "/openapi.json");
    close_objects(document_["components"]);
    close_objects(document_["paths"]);
  }
  /// Sends a request. Expects an answer with this status, and as described.
  Answer described(const std::string& method, const std::string& target, unsigned status,
                   const std::string& body = {}, const Headers& headers = {}) {
    SCOPED_TRACE(method + " " + target);
    Answer answer = ask(method, target, body, headers);
    EXPECT_EQ(answer.status, status) << answer.body;
    const Json& responses = operation(method, target.substr(0, target.find('?'))).at("responses");
    const std::string text = std::to_string(answer.status);
    EXPECT_TRUE(responses.contains(text));
    if (responses.contains(text)) check(responses.at(text), answer);
    return answer;
  }
  Json json(const std::string& method, const std::string& target, unsigned status,
            const std::string& body = {}) {
    return described(method, target, status, body).json();
  }

 private:
  const Json& resolved(const Json& value) const {
    if (!value.contains("$ref")) return value;
    return document_.at(Json::json_pointer(value.at("$ref").get<std::string>().substr(1)));
  }
  const Json& operation(const std::string& method, const std::string& path) const {
    std::string best;
    for (const auto& [pattern, operations] : document_.at("paths").items()) {
      const bool is_better =
          best.empty() || std::ranges::count(pattern, '{') < std::ranges::count(best, '{');
      if (fits(pattern, path) && is_better) best = pattern;
    }
    std::string key = method;
    std::ranges::transform(key, key.begin(), [](char c) { return static_cast<char>(c | 0x20); });
    return document_.at("paths").at(best).at(key);
  }
  void check(const Json& given, const Answer& answer) const {
    const Json& response = resolved(given);
    if (!response.contains("content")) return;
    const Json& content = response.at("content");
    const std::string type = answer.header("Content-Type");
    ASSERT_TRUE(content.contains(type)) << type;
    if (type != "application/json") return;
    Json root = {{"components", document_.at("components")}, {"schema", content[type]["schema"]}};
    root["$ref"] = root["schema"].value("$ref", "#/schema");
    for (const SchemaFault& fault : JsonSchema(root).faults(answer.json())) {
      ADD_FAILURE() << fault.path << ": " << fault.keyword << " in " << answer.body;
    }
    if (answer.status < 400) return;
    const std::string codes =
        given.contains("description") ? given.at("description") : response.at("description");
    EXPECT_TRUE(codes.contains('`' + answer.code() + '`')) << answer.code() << " not in " << codes;
  }

  Json document_;
};

constexpr const char* kBlockPath = "/v1/sessions/block";

TEST_F(DescribedAnswers, OfTheServerAndItsSessions) {
  described("GET", "/healthz", 200);
  described("GET", "/readyz", 200);
  described("GET", "/metrics", 200);
  described("GET", "/openapi.json", 200);
  described("GET", "/v1/templates", 200);
  described("GET", "/v1/sessions", 200);
  described("POST", "/v1/sessions?dry_run=1", 200, kBlock.dump());
  const Json scene = scene_with({{"accuracy", {{"target_mm", 0.5}}}});
  described("POST", "/v1/sessions?id=target", 201, scene.dump());
  described("POST", "/v1/sessions?id=target", 409, scene.dump());
  described("POST", "/v1/sessions?id=Bad", 400, scene.dump());
  described("POST", "/v1/sessions", 400, "{}");
  described("POST", "/v1/sessions?from=block&id=branch", 201);
  described("GET", "/v1/sessions/branch", 200);
  described("GET", "/v1/sessions/none", 404);
  described("DELETE", "/v1/sessions/branch", 200);
  const Json closed = json("GET", "/v1/closed", 200).at("closed");
  ASSERT_EQ(closed.size(), 1U);
  const std::string path = "/v1/closed/" + closed[0].at("name").get<std::string>();
  described("POST", path, 201);
  described("DELETE", path, 404);
  described("POST", "/v1/files?name=a.obj", 201, kTetrahedron);
  described("POST", "/v1/files?name=a.txt", 400, kTetrahedron);
  described("POST", "/v1/drain?to=nowhere", 400);
}

TEST_F(DescribedAnswers, OfProgramsAndDownloads) {
  const std::string block = kBlockPath;
  const std::string programs = block + "/programs";
  described("POST", block + "/targets?name=a.obj", 201, kTetrahedron);
  const Json begun = json("POST", programs + "?target=a.obj&force_limit_n=0.001", 202, kProgram);
  wait_for(begun, "finished");
  const std::string program = begun.at("url");
  described("GET", programs, 200);
  described("GET", program, 200);
  described("GET", program + "/source", 200);
  described("GET", program + "/path?points=3", 200);
  described("PATCH", program + "?do=pause", 409);
  described("PATCH", program + "?do=jump", 400);
  described("DELETE", programs + "/99", 404);
  described("POST", programs, 400, "G1 X\n");
  described("POST", "/v1/programs", 200,
            "(T4 6MM BALL ENDMILL)\nG21 G90\nT4 M6\nG0 X1 Y2 Z5\nG1 Z-3 F60\nG1 X9\nM30\n");
  const Json priced = {{"scene", kBlock},
                       {"program", "G21 G90 F600\nT1 M6\nG0 X0 Y0 Z5\nG1 Z-1\nM30\n"}};
  described("POST", "/v1/prices", 200, priced.dump());
  described("POST", "/v1/prices", 400, "{}");
  for (const char* name : {"model.stl", "model.glb", "model.3mf", "model.ply", "model.obj",
                           "program.ngc", "program.apt", "forces.csv", "forces?points=5",
                           "thin_walls.json", "journal", "exports", "picture.png?width=240"}) {
    described("GET", block + "/" + name, 200);
  }
  described("GET", block + "/model.stl?encoding=zip", 400);
  described("GET", block + "/program.ngc?post=grbl", 422);
  described("GET", block + "/program.ngc", 206, "", {{"Range", "bytes=0-9"}});
}

TEST_F(DescribedAnswers, OfTheSurfaceAndTheHistory) {
  const std::string block = kBlockPath;
  Hand ada(port);
  ada.carve(60);
  wait_for_the_journal();
  described("GET", block, 200);
  described("GET", block + "/probe?at_mm=-19,-19,0&normal=0,0,1", 200);
  described("GET", block + "/probe?at_mm=4,0,-2&normal=0,0,1", 200);
  described("GET", block + "/probe?at_mm=4", 400);
  described("POST", block + "/owners", 200, std::string(24, '\0'));
  described("POST", block + "/targets?name=a.obj&unit=cm", 201, kTetrahedron);
  described("GET", block + "/targets", 200);
  described("GET", block + "/targets/a.obj/deviation", 200);
  described("POST", block + "/targets/a.obj/distances", 200, std::string(12, '\0'));
  described("DELETE", block + "/targets/a.obj", 200);
  described("GET", block + "/authors", 200);
  described("GET", block + "/strokes", 200);
  described("POST", block + "/undo", 400);
  described("POST", block + "/undo?participant=77", 409);
  described("POST", block + "/versions?name=first&at=1", 201);
  described("GET", block + "/versions", 200);
  described("PATCH", block + "/versions/first?name=second", 200);
  described("DELETE", block + "/versions/second", 200);
  described("POST", block + "/pins?text=here&at_mm=1,2,0&normal=0,0,1", 201);
  described("GET", block + "/pins", 200);
  described("DELETE", block + "/pins/1", 200);
  const std::string journal = json("GET", block + "/replay", 200).at("journal");
  described("GET", block + "/hashes?journal=" + journal, 200);
  described("GET", block + "/origin?journal=" + journal, 200);
  described("GET", block + "/records?journal=" + journal + "&first=1&last=9", 200);
  described("GET", block + "/origin?journal=other", 404);
}

TEST_F(DescribedAnswers, OfPeople) {
  const std::string block = kBlockPath;
  Hand ada(port);
  const std::string person = block + "/participants/" + std::to_string(ada.participant);
  described("POST", block + "/invitations?role=owner", 409);
  described("POST", block + "/join", 200);
  described("GET", block + "/invitations", 200);
  described("POST", person + "?muted=1", 200);
  described("POST", person + "?role=owner", 409);
  described("POST", block + "/regions?min_mm=0,0,0&max_mm=1,1,1", 201);
  described("GET", block + "/regions", 200);
  described("DELETE", block + "/regions/1", 200);
  described("DELETE", block + "/regions/1", 404);
  described("DELETE", person, 200);
}

TEST_F(DescribedAnswers, OfAServerWithRights) {
  admin = "0123456789abcdef0123456789abcdef";
  restart();
  const std::string block = kBlockPath;
  const Json invitation = json("POST", block + "/invitations?role=sculptor&hours=2", 201);
  const Headers token = bearer(invitation.at("token"));
  described("GET", block, 401, "", bearer("kerf_000000000000_00000000000000000000000000000000"));
  described("DELETE", block, 403, "", token);
  described("POST", block + "/join?name=Bo", 201, "", token);
  described("GET", block + "/invitations", 200);
  described("DELETE", block + "/invitations/" + invitation.at("id").get<std::string>(), 200);
  described("DELETE", block + "/invitations/none", 404);
}

}  // namespace
}  // namespace kerf::test::described_answers_test
