// SPDX-License-Identifier: Apache-2.0
#include "server/formats/bounded_json.h"

#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace kerf {
namespace {

using Json = nlohmann::json;

/// Values between two polls of the stop.
constexpr std::size_t kLookEvery = 4096;

/// Builds a document from the parser's events. A function that returns false ends the parsing.
class DocumentBuilder final : public nlohmann::json_sax<Json> {
 public:
  explicit DocumentBuilder(const JsonRules& rules) : rules_(rules) {}

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t&) override { return fail(JsonFaultKind::kSyntax); }  // not in text
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& value) override {
    if (dropped_ > 0) return true;
    key_ = std::move(value);
    if (rules_.takes_repeated_keys || !open_.back()->contains(key_)) return true;
    fault_.key = key_;
    return fail(JsonFaultKind::kRepeatedKey);
  }
  bool parse_error(std::size_t byte, const std::string&, const Json::exception& error) override {
    // 406 is the library's "number overflow".
    constexpr int kNumberOverflow = 406;
    fault_.byte = byte > 0 ? byte - 1 : 0;
    return fail(error.id == kNumberOverflow ? JsonFaultKind::kRange : JsonFaultKind::kSyntax);
  }

  Json take() { return std::move(document_); }
  const JsonFault& fault() const { return fault_; }

 private:
  bool fail(JsonFaultKind kind) {
    fault_.kind = kind;
    return false;
  }

  bool goes_on() {
    if (++seen_ % kLookEvery != 0 || !rules_.is_stopped || !rules_.is_stopped()) return true;
    return fail(JsonFaultKind::kStopped);
  }

  bool is_too_deep() const { return std::cmp_greater_equal(open_.size(), rules_.depth_max); }

  /// Adds a value at the parser's position.
  Json& place(Json&& value) {
    ++values_;
    if (open_.empty()) return document_ = std::move(value);
    Json& parent = *open_.back();
    if (parent.is_object()) return parent[key_] = std::move(value);
    parent.push_back(std::move(value));
    return parent.back();
  }

  bool put(Json value) {
    const bool is_left_out = dropped_ > 0 || (rules_.drops_deeper && is_too_deep());
    if (!is_left_out && values_ == rules_.values_max) return fail(JsonFaultKind::kTooMany);
    if (!is_left_out) place(std::move(value));
    return goes_on();
  }

  // A container must not move while a nested one is open.
  bool open(Json container) {
    if (dropped_ > 0 || is_too_deep()) {
      if (!rules_.drops_deeper) return fail(JsonFaultKind::kTooDeep);
      ++dropped_;
    } else if (values_ == rules_.values_max) {
      return fail(JsonFaultKind::kTooMany);
    } else {
      open_.push_back(&place(std::move(container)));
    }
    return goes_on();
  }

  bool close() {
    if (dropped_ > 0) {
      --dropped_;
    } else {
      open_.pop_back();
    }
    return true;
  }

  const JsonRules& rules_;
  Json document_;
  std::vector<Json*> open_;  ///< lists and objects that have not ended, the outermost first
  std::size_t dropped_ = 0;  ///< open ones that are dropped
  std::string key_;          ///< of the next value
  std::size_t values_ = 0, seen_ = 0;  ///< of the document; of the text
  JsonFault fault_;
};

}  // namespace

std::expected<JsonDocument, JsonFault> parse_bounded_json(std::string_view text,
                                                          const JsonRules& rules) {
  DocumentBuilder builder(rules);
  if (!Json::sax_parse(text, &builder)) return std::unexpected(builder.fault());
  return std::make_shared<Json>(builder.take());
}

}  // namespace kerf
