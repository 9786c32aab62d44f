// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kernel/math/vec3.h"

namespace kerf {

// How the files that read a scene take values out of its JSON, and say where one is wrong.

/// Leaves the reader from any depth; parse_scene catches it, nobody else sees it.
struct SceneRejection {
  std::string path, reason;
};

/// One value of the document while it is read. Every function rejects, with the value's path, what
/// is not of its type or out of range.
class SceneValue {
 public:
  /// `json` is the parser's node; it outlives this.
  SceneValue(const void* json, std::string path) : json_(json), path_(std::move(path)) {}

  const std::string& path() const { return path_; }
  [[noreturn]] void reject(const std::string& reason) const { throw SceneRejection{path_, reason}; }
  bool is_list() const;
  bool is_object() const;
  bool is_text() const;
  /// Above `above`, at most `most`.
  double number(double above = -kInfinity, double most = kInfinity) const;
  std::string text() const;
  /// Rejects a list of more than 1000 items.
  std::vector<SceneValue> items() const;
  template <std::size_t N>
  std::array<double, N> numbers() const {
    std::array<double, N> result{};
    read_numbers(result);
    return result;
  }

 private:
  friend class SceneFields;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  void read_numbers(std::span<double> into) const;

  const void* json_;
  std::string path_;
};

/// One object: hands out its fields and, at the end, rejects those nobody asked for.
class SceneFields {
 public:
  explicit SceneFields(SceneValue object);

  [[noreturn]] void reject(const std::string& field, const std::string& reason) const {
    throw SceneRejection{path_of(field), reason};
  }
  std::optional<SceneValue> find(const std::string& field);
  SceneValue need(const std::string& field);

  double positive(const std::string& field) { return need(field).number(0); }
  double positive(const std::string& field, double otherwise) {
    const auto value = find(field);
    return value ? value->number(0) : otherwise;
  }
  double any_number(const std::string& field) { return need(field).number(); }
  double not_negative(const std::string& field, double otherwise);
  std::string text(const std::string& field) { return need(field).text(); }
  std::string text(const std::string& field, const std::string& otherwise) {
    const auto value = find(field);
    return value ? value->text() : otherwise;
  }
  template <std::size_t N>
  std::array<double, N> numbers(const std::string& field) {
    return need(field).numbers<N>();
  }
  Vec3 vec3(const std::string& field) {
    const auto v = numbers<3>(field);
    return {v[0], v[1], v[2]};
  }

  /// Call last.
  void reject_the_rest() const;

 private:
  std::string path_of(const std::string& field) const {
    return object_.path_.empty() ? field : object_.path_ + "." + field;
  }

  SceneValue object_;
  std::set<std::string> asked_;
};

}  // namespace kerf
