// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <optional>

#include "haptic_agent/device/pose_script.h"
#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {
namespace {

/// Words that do not affect the path.
constexpr std::array<std::string_view, 13> kWordsWithoutMotion = {
    "PARTNO", "PPRINT", "REMARK", "MACHIN", "MULTAX", "CUTTER", "SPINDL",
    "COOLNT", "INTOL",  "OUTTOL", "TOLER",  "STOP",   "OPSTOP"};
/// Words followed by free text.
constexpr std::array<std::string_view, 3> kTextWords = {"PARTNO", "PPRINT", "REMARK"};

constexpr double kSPerMinute = 60.0;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;
/// Between opposite axes the direction of rotation is undefined.
constexpr double kOppositeDot = -0.999;

std::string upper(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return result;
}

class AptReader {
 public:
  explicit AptReader(const std::string& name) : name_(name) {}

  std::expected<PoseScript, ScriptError> read(std::string_view text) {
    while (!ended_) {
      if (!take_statement(text)) break;
      if (auto ok = obey(); !ok) return std::unexpected(ok.error());
      statement_.clear();
    }
    if (script_.empty()) return reject_file("contains no GOTO");
    return std::move(script_);
  }

 private:
  using Done = std::expected<void, ScriptError>;

  std::unexpected<ScriptError> reject(std::string reason) const {
    return std::unexpected(ScriptError{name_, statement_line_, std::move(reason)});
  }
  std::unexpected<ScriptError> reject_file(std::string reason) const {
    return std::unexpected(ScriptError{name_, 0, std::move(reason)});
  }

  /// Reads one statement without comments, with continuation lines joined. Returns false at the end
  /// of the text.
  bool take_statement(std::string_view& text) {
    statement_line_ = line_ + 1;
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      std::string_view line = text.substr(0, end);
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      ++line_;
      line = trim(line.substr(0, line.find("$$")));
      const bool continues = line.find('$') != std::string_view::npos;
      line = line.substr(0, line.find('$'));
      statement_ += line;
      if (continues) continue;
      if (!statement_.empty()) return true;
      statement_line_ = line_ + 1;
    }
    return !statement_.empty();
  }

  Done obey() {
    const std::size_t slash = statement_.find_first_of("/ \t");
    const std::string word = upper(std::string_view(statement_).substr(0, slash));
    if (std::ranges::find(kTextWords, word) != kTextWords.end()) return {};
    const std::size_t bar = statement_.find('/');
    const bool has_fields = bar != std::string::npos;
    fields_ = has_fields ? split_fields(std::string_view(statement_).substr(bar + 1))
                         : std::vector<std::string_view>{};
    if (word == "GOTO") return go_to();
    if (word == "FROM") {
      placing_move_ = true;
      return go_to();
    }
    if (word == "FEDRAT") return feed();
    if (word == "LOADTL") return load_tool();
    if (word == "UNITS") return units();
    if (word == "DELAY") return delay();
    if (word == "FINI" || word == "END") {
      ended_ = true;
      return {};
    }
    if (word == "RAPID") {
      rapid_ = true;
      return {};
    }
    if (std::ranges::find(kWordsWithoutMotion, word) != kWordsWithoutMotion.end()) return {};
    return reject(join({"the word ", word, " is not supported"}));
  }

  Done go_to() {
    if (fields_.size() != 3 && fields_.size() != 6) return reject("GOTO needs 3 or 6 numbers");
    std::array<double, 6> v{};
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const auto number = to_number(fields_[i]);
      if (!number) return reject(join({"'", fields_[i], "' is not a finite number"}));
      v[i] = *number;
    }
    TimedPose pose{.tip_mm = {v[0], v[1], v[2]}, .axis = axis_, .tool_id = tool_id_};
    if (fields_.size() == 6) {
      const Vec3 axis{v[3], v[4], v[5]};
      if (length(axis) < kAxisMinLength) return reject("the tool axis must not be of length zero");
      pose.axis = axis_ = normalized(axis);
    }
    return append(pose);
  }

  Done append(TimedPose pose) {
    if (script_.empty()) {
      pose.cutting = false;
    } else {
      const TimedPose& last = script_.back();
      if (dot(last.axis, pose.axis) < kOppositeDot) {
        return reject("the axis turns by 180 degrees in one move; the direction is undefined");
      }
      pose.cutting = !placing_move_;
      const bool fast = rapid_ || placing_move_;
      if (!fast && !feed_per_s_) return reject("GOTO without a preceding FEDRAT or RAPID");
      // If the tip does not move, the feed is in degrees per minute, as in G-code.
      const MoveSpeed speed =
          fast ? MoveSpeed{} : MoveSpeed{*feed_per_s_, *feed_per_s_ * kRadPerDeg};
      pose.time_s = last.time_s + travel_time_s(last, pose, speed);
    }
    script_.push_back(pose);
    placing_move_ = false;
    rapid_ = false;
    return {};
  }

  Done feed() {
    const auto value = fields_.empty() ? std::nullopt : to_number(fields_[0]);
    if (!value || *value <= 0) return reject("FEDRAT must be a number above zero");
    if (fields_.size() > 2) return reject("FEDRAT has too many fields");
    if (fields_.size() == 2 && upper(fields_[1]) != "MMPM" && upper(fields_[1]) != "PERMIN") {
      return reject(join({"FEDRAT must be in MMPM, not in ", fields_[1]}));
    }
    feed_per_s_ = *value / kSPerMinute;
    rapid_ = false;
    return {};
  }

  Done load_tool() {
    const auto value = fields_.empty() ? std::nullopt : to_number(fields_[0]);
    constexpr double kMax = 1e9;
    if (!value || *value < 1 || *value > kMax || *value != std::floor(*value)) {
      return reject("LOADTL must be an integer above zero");
    }
    tool_id_ = static_cast<std::uint32_t>(*value);
    placing_move_ = true;
    return {};
  }

  Done units() {
    if (fields_.size() != 1 || upper(fields_[0]) != "MM") return reject("UNITS must be MM");
    return {};
  }

  Done delay() {
    const auto value = fields_.empty() ? std::nullopt : to_number(fields_[0]);
    if (!value || *value < 0) return reject("DELAY must be a number of seconds >= 0");
    if (script_.empty()) return {};
    TimedPose rest = script_.back();
    rest.time_s += *value;
    rest.cutting = false;
    script_.push_back(rest);
    return {};
  }

  const std::string& name_;
  std::size_t line_ = 0;
  std::size_t statement_line_ = 0;
  std::string statement_;
  std::vector<std::string_view> fields_;
  PoseScript script_;
  Vec3 axis_{0, 0, 1};
  std::uint32_t tool_id_ = 0;
  std::optional<double> feed_per_s_;
  bool rapid_ = false;
  bool ended_ = false;
  bool placing_move_ = false;  // the next move is the first after FROM or LOADTL
};

}  // namespace

std::expected<PoseScript, ScriptError> parse_apt_script(const std::string& name,
                                                        std::string_view text) {
  return AptReader(name).read(text);
}

}  // namespace kerf::agent
