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

// Typed access to the JSON values of a scene, with the path of an invalid value in every error.
// Used by the readers of scenes only. Keeps nlohmann-json out of their headers.

/// Thrown by the functions below for an invalid value. parse_scene turns it into a SceneError. It
/// never leaves the scene reader.
struct SceneRejection {
  std::string path;    ///< JSON path, e.g. "tools[0].diameter_mm"
  std::string reason;  ///< one clause
};

/// One JSON value of a scene with its path. Every accessor throws SceneRejection if the value has
/// another type or is out of range.
class SceneValue {
 public:
  /// `json` is a node of the parsed document, which must outlive this object.
  SceneValue(const void* json, std::string path) : json_(json), path_(std::move(path)) {}

  const std::string& path() const { return path_; }
  [[noreturn]] void reject(const std::string& reason) const { throw SceneRejection{path_, reason}; }
  bool is_list() const;
  bool is_object() const;
  bool is_text() const;
  /// A finite number, > `above` and <= `most`.
  double number(double above = -kInfinity, double most = kInfinity) const;
  std::string text() const;
  bool flag() const;
  /// The items of a list; at most `most`.
  std::vector<SceneValue> items(std::size_t most = kItemsMax) const;
  /// A list of exactly N finite numbers.
  template <std::size_t N>
  std::array<double, N> numbers() const {
    std::array<double, N> result{};
    read_numbers(result);
    return result;
  }

 private:
  friend class SceneFields;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  /// Limit for hostile input; far above any real scene.
  static constexpr std::size_t kItemsMax = 1000;
  void read_numbers(std::span<double> into) const;

  const void* json_;
  std::string path_;
};

/// The fields of one JSON object. Read all of them, then call reject_unknown().
class SceneFields {
 public:
  /// Throws SceneRejection unless `object` is a JSON object.
  explicit SceneFields(SceneValue object);

  [[noreturn]] void reject(const std::string& field, const std::string& reason) const {
    throw SceneRejection{path_of(field), reason};
  }
  /// The value of an optional field.
  std::optional<SceneValue> find(const std::string& field);
  /// The value of a required field.
  SceneValue required(const std::string& field);

  // Typed fields. Those with a `standard` value are optional.
  double positive(const std::string& field) { return required(field).number(0); }
  double positive(const std::string& field, double standard) {
    const auto value = find(field);
    return value ? value->number(0) : standard;
  }
  double number(const std::string& field) { return required(field).number(); }
  double not_negative(const std::string& field, double standard);
  std::string text(const std::string& field) { return required(field).text(); }
  std::string text(const std::string& field, const std::string& standard) {
    const auto value = find(field);
    return value ? value->text() : standard;
  }
  template <std::size_t N>
  std::array<double, N> numbers(const std::string& field) {
    return required(field).numbers<N>();
  }
  Vec3 vec3(const std::string& field) {
    const auto v = numbers<3>(field);
    return {v[0], v[1], v[2]};
  }

  /// Throws SceneRejection for a field that was not passed to any function above. Call last.
  void reject_unknown() const;

 private:
  std::string path_of(const std::string& field) const {
    return object_.path_.empty() ? field : object_.path_ + "." + field;
  }

  SceneValue object_;
  std::set<std::string> read_;
};

}  // namespace kerf
