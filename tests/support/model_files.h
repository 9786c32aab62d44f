// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/glb_reader.h"
#include "tests/support/test.h"

namespace kerf::test {

using Corner = std::array<float, 3>;
/// A model as another program would read it from a file.
struct ReadModel {
  std::vector<Corner> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<std::uint8_t, 3>> colors;
  std::vector<float> deviations;
};

inline ReadModel read_stl_bytes(const std::string& bytes) {
  ReadModel model;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  EXPECT_EQ(bytes.size(), 84 + std::size_t{50} * count);
  for (std::uint32_t f = 0; f < count; ++f) {
    for (std::uint32_t c = 0; c < 3; ++c) {
      Corner corner;
      std::memcpy(corner.data(), bytes.data() + 84 + std::size_t{50} * f + 12 + 12 * c, 12);
      model.vertices.push_back(corner);
    }
    model.triangles.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  return model;
}

inline ReadModel read_stl_text(const std::string& text) {
  ReadModel model;
  std::istringstream in(text);
  for (std::string word; in >> word;) {
    if (word != "vertex") continue;
    Corner corner;
    in >> corner[0] >> corner[1] >> corner[2];
    const auto n = static_cast<std::uint32_t>(model.vertices.size());
    model.vertices.push_back(corner);
    if (n % 3 == 2) model.triangles.push_back({n - 2, n - 1, n});
  }
  return model;
}

inline ReadModel read_obj_text(const std::string& text, std::size_t* normals = nullptr) {
  ReadModel model;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      Corner corner;
      words >> corner[0] >> corner[1] >> corner[2];
      model.vertices.push_back(corner);
    } else if (word == "vn" && normals != nullptr) {
      ++*normals;
    } else if (word == "f") {
      auto& triangle = model.triangles.emplace_back();
      for (std::uint32_t& n : triangle) {
        words >> word;
        n = static_cast<std::uint32_t>(std::stoul(word)) - 1;
      }
    }
  }
  return model;
}

inline ReadModel read_ply_bytes(const std::string& bytes) {
  ReadModel model;
  const std::size_t header = bytes.find("end_header\n") + 11;
  std::istringstream in(bytes.substr(0, header));
  std::size_t vertices = 0, faces = 0;
  bool colors = false, quality = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("element vertex ")) vertices = std::stoul(line.substr(15));
    if (line.starts_with("element face ")) faces = std::stoul(line.substr(13));
    colors = colors || line == "property uchar red";
    quality = quality || line == "property float quality";
  }
  const char* at = bytes.data() + header;
  const std::size_t stride = 12U + (colors ? 3U : 0U) + (quality ? 4U : 0U);
  EXPECT_EQ(bytes.size(), header + stride * vertices + 13 * faces);
  for (std::size_t n = 0; n < vertices; ++n, at += stride) {
    std::memcpy(model.vertices.emplace_back().data(), at, 12);
    if (colors) std::memcpy(model.colors.emplace_back().data(), at + 12, 3);
    if (quality) std::memcpy(&model.deviations.emplace_back(), at + stride - 4, 4);
  }
  for (std::size_t n = 0; n < faces; ++n, at += 13) {
    EXPECT_EQ(*at, 3);
    std::memcpy(model.triangles.emplace_back().data(), at + 1, 12);
  }
  return model;
}

/// Returns positions in mm from the block's corner, without the node's translation, which has a
/// test of its own.
inline ReadModel read_model_glb(const std::string& bytes) {
  const auto* first = reinterpret_cast<const std::byte*>(bytes.data());
  const GlbParts glb = split_glb({first, first + bytes.size()});
  ReadModel model;
  if (!glb.json.contains("meshes")) return model;
  const auto& node = glb.json["nodes"][0];
  const double step_mm = node["scale"][0].get<double>() * 1000;
  for (const auto& primitive : glb.json["meshes"][node["mesh"].get<std::size_t>()]["primitives"]) {
    const auto accessor = [&](const nlohmann::json& n) {
      return glb.json["accessors"][n.get<std::size_t>()];
    };
    const auto bytes_of = [&](const nlohmann::json& a) {
      return view_bytes(glb, glb.json["bufferViews"][a["bufferView"].get<std::size_t>()]);
    };
    const auto position = accessor(primitive["attributes"]["POSITION"]);
    const auto positions = bytes_of(position);
    const auto base = static_cast<std::uint32_t>(model.vertices.size());
    for (std::size_t n = 0; n < position["count"].get<std::size_t>(); ++n) {
      if (position["componentType"] == 5126) {
        model.vertices.push_back(element<float, 3>(positions, 12, n));
        continue;
      }
      const auto steps = element<std::int16_t, 3>(positions, 8, n);
      Corner corner;
      for (std::size_t c = 0; c < 3; ++c) {
        corner[c] = static_cast<float>((steps[c] + 32768) * step_mm);
      }
      model.vertices.push_back(corner);
    }
    const auto index = accessor(primitive["indices"]);
    const auto indices = bytes_of(index);
    for (std::size_t t = 0; t < index["count"].get<std::size_t>() / 3; ++t) {
      auto& triangle = model.triangles.emplace_back();
      for (std::size_t c = 0; c < 3; ++c) {
        triangle[c] = base + (index["componentType"] == 5125
                                  ? element<std::uint32_t, 1>(indices, 4, 3 * t + c)[0]
                                  : element<std::uint16_t, 1>(indices, 2, 3 * t + c)[0]);
      }
    }
  }
  return model;
}

/// Returns triangles as corners, in an order that does not depend on the file's: smallest corner
/// first.
inline std::vector<std::array<Corner, 3>> sorted_triangles(const ReadModel& model) {
  std::vector<std::array<Corner, 3>> all;
  for (const auto& t : model.triangles) {
    std::array<Corner, 3> corners{model.vertices.at(t[0]), model.vertices.at(t[1]),
                                  model.vertices.at(t[2])};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    all.push_back(corners);
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// Returns the number of directed edges, by vertex number, without exactly one opposite edge.
inline std::size_t unmatched_edges(const ReadModel& model) {
  std::map<std::array<std::uint32_t, 2>, int> edges;
  for (const auto& t : model.triangles) {
    for (std::size_t c = 0; c < 3; ++c) ++edges[{t[c], t[(c + 1) % 3]}];
  }
  std::size_t unmatched = 0;
  for (const auto& [edge, count] : edges) {
    const auto opposite = edges.find({edge[1], edge[0]});
    unmatched += count != 1 || opposite == edges.end() || opposite->second != 1 ? 1 : 0;
  }
  return unmatched;
}

inline double volume_mm3(const ReadModel& model) {
  double volume = 0;
  for (const auto& t : model.triangles) {
    std::array<Vec3, 3> p;
    for (std::size_t c = 0; c < 3; ++c) {
      const Corner& v = model.vertices.at(t[c]);
      p[c] = {double(v[0]), double(v[1]), double(v[2])};
    }
    volume += dot(p[0], cross(p[1], p[2])) / 6;
  }
  return volume;
}

}  // namespace kerf::test
