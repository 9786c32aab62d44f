// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <optional>

#include "haptic_agent/device/pose_script.h"
#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {
namespace {

constexpr std::array<std::string_view, 7> kColumns = {"t_s", "x", "y", "z", "i", "j", "k"};
constexpr std::size_t kCuttingColumn = 7;
constexpr std::size_t kToolColumn = 8;
constexpr std::size_t kColumnCount = 9;
constexpr double kMaxToolId = 1e9;

class CsvReader {
 public:
  explicit CsvReader(const std::string& name) : name_(name) {}

  std::expected<PoseScript, ScriptError> read(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      const std::string_view line = trim(text.substr(0, end));
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      ++line_;
      if (line.empty()) continue;
      const auto fields = split_fields(line);
      const auto done = has_header_ ? row(fields) : header(fields);
      if (!done) return std::unexpected(done.error());
    }
    line_ = 0;
    if (!has_header_) return reject("is empty");
    if (script_.empty()) return reject("has no row below the header");
    return std::move(script_);
  }

 private:
  using Done = std::expected<void, ScriptError>;

  std::unexpected<ScriptError> reject(std::string reason) const {
    return std::unexpected(ScriptError{name_, line_, std::move(reason)});
  }

  Done header(const std::vector<std::string_view>& fields) {
    const auto find = [&](std::string_view column) -> std::optional<std::size_t> {
      const auto at = std::ranges::find(fields, column);
      if (at == fields.end()) return std::nullopt;
      return static_cast<std::size_t>(at - fields.begin());
    };
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      at_[i] = find(kColumns[i]);
      if (!at_[i]) return reject(join({"the header has no column ", kColumns[i]}));
    }
    at_[kCuttingColumn] = find("cutting");
    at_[kToolColumn] = find("tool");
    width_ = fields.size();
    has_header_ = true;
    return {};
  }

  Done row(const std::vector<std::string_view>& fields) {
    if (fields.size() != width_) {
      return reject(join({"has ", std::to_string(fields.size()), " fields, the header has ",
                          std::to_string(width_)}));
    }
    std::array<double, kColumnCount> v{};
    for (std::size_t i = 0; i < kColumnCount; ++i) {
      const std::optional<std::size_t>& column = at_[i];
      if (!column) continue;
      const std::string_view field = fields[*column];
      const auto number = to_number(field);
      if (!number) return reject(join({"'", field, "' is not a finite number"}));
      v[i] = *number;
    }
    const Vec3 axis{v[4], v[5], v[6]};
    if (length(axis) < kAxisMinLength) return reject("the tool axis must not be of length zero");
    if (v[kToolColumn] < 0 || v[kToolColumn] > kMaxToolId) return reject("tool is out of range");
    if (!script_.empty() && v[0] < script_.back().time_s) return reject("t_s must not decrease");
    const bool cutting = !script_.empty() && (!at_[kCuttingColumn] || v[kCuttingColumn] != 0);
    script_.push_back({.time_s = v[0],
                       .tip_mm = {v[1], v[2], v[3]},
                       .axis = normalized(axis),
                       .cutting = cutting,
                       .tool_id = static_cast<std::uint32_t>(v[kToolColumn])});
    return {};
  }

  const std::string& name_;
  std::size_t line_ = 0;
  std::size_t width_ = 0;
  bool has_header_ = false;
  std::array<std::optional<std::size_t>, kColumnCount> at_;
  PoseScript script_;
};

}  // namespace

std::expected<PoseScript, ScriptError> parse_csv_script(const std::string& name,
                                                        std::string_view text) {
  return CsvReader(name).read(text);
}

}  // namespace kerf::agent
