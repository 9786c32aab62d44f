// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/nats/nats_store.h"

#include <algorithm>

namespace kerf::sim {
namespace {

std::unexpected<NatsError> absent() {
  return std::unexpected(NatsError{NatsErrorCode::kAbsent, "NATS: the stream does not exist"});
}

}  // namespace

bool matches(std::string_view subject, std::string_view pattern) {
  const auto word = [](std::string_view& text) {
    const std::size_t end = std::min(text.find('.'), text.size());
    const std::string_view first = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return first;
  };
  while (!subject.empty() && !pattern.empty()) {
    const std::string_view wanted = word(pattern), given = word(subject);
    if (wanted == ">") return true;
    if (wanted != "*" && wanted != given) return false;
  }
  return subject.empty() && pattern.empty();
}

const NatsStore::Stream* NatsStore::find(const std::string& stream) const {
  const auto found = streams_.find(stream);
  return found == streams_.end() ? nullptr : &found->second;
}

NatsStore::Stream* NatsStore::of_subject(const std::string& subject) {
  for (auto& [name, stream] : streams_) {
    if (matches(subject, stream.subject)) return &stream;
  }
  return nullptr;
}

void NatsStore::make(const std::string& stream, const std::string& subject, Keep keep) {
  const auto [made, is_new] = streams_.try_emplace(stream);
  if (!is_new) return;
  made->second.subject = subject;
  made->second.keep = keep;
}

bool NatsStore::remove(const std::string& stream) { return streams_.erase(stream) > 0; }

std::vector<std::string> NatsStore::names() const {
  std::vector<std::string> names;
  for (const auto& [name, stream] : streams_) names.push_back(name);
  return names;
}

NatsResult<void> NatsStore::purge(const std::string& stream, std::uint64_t first) {
  const auto found = streams_.find(stream);
  if (found == streams_.end()) return absent();
  auto& messages = found->second.messages;
  messages.erase(messages.begin(), messages.lower_bound(first));
  std::erase_if(found->second.newest, [&](const auto& entry) { return entry.second < first; });
  return {};
}

NatsResult<std::optional<StreamMessage>> NatsStore::last(const std::string& stream,
                                                         const std::string& subject) const {
  const Stream* found = find(stream);
  if (found == nullptr) return absent();
  std::uint64_t newest = 0;
  for (const auto& [name, number] : found->newest) {
    if (matches(name, subject)) newest = std::max(newest, number);
  }
  if (newest == 0) return std::nullopt;
  return found->messages.at(newest);
}

std::uint64_t NatsStore::store(Stream& stream, const std::string& subject,
                               std::span<const std::byte> bytes) {
  const std::uint64_t number = ++stream.last;
  const auto before = stream.newest.find(subject);
  if (stream.keep == Keep::kLastOfSubject && before != stream.newest.end()) {
    stream.messages.erase(before->second);
  }
  stream.newest[subject] = number;
  stream.messages[number] = {number, {bytes.begin(), bytes.end()}, subject};
  return number;
}

NatsResult<std::uint64_t> NatsStore::publish(const std::string& subject,
                                             std::span<const std::byte> bytes,
                                             const std::string& id, std::uint64_t after,
                                             Clock::time_point now) {
  Stream* stream = of_subject(subject);
  if (stream == nullptr) {
    return std::unexpected(NatsError{NatsErrorCode::kRefused, "NATS: no stream has the subject"});
  }
  std::erase_if(stream->ids, [&](const auto& known) { return now - known.second.at > kRemembers; });
  if (const auto known = stream->ids.find(id); known != stream->ids.end()) {
    return known->second.sequence;
  }
  const auto newest = stream->newest.find(subject);
  const std::uint64_t last = newest == stream->newest.end() ? 0 : newest->second;
  // Of a first message it is expected that the subject has none.
  if (last != after) {
    return std::unexpected(
        NatsError{NatsErrorCode::kNotNext, "NATS: wrong last sequence: " + std::to_string(last)});
  }
  const std::uint64_t number = store(*stream, subject, bytes);
  stream->ids[id] = {number, now};
  return number;
}

void NatsStore::add(const std::string& subject, std::span<const std::byte> bytes) {
  if (Stream* stream = of_subject(subject)) store(*stream, subject, bytes);
}

NatsResult<std::optional<StreamMessage>> NatsStore::next(const std::string& stream,
                                                         const std::string& subject,
                                                         std::uint64_t first) const {
  const Stream* found = find(stream);
  if (found == nullptr) return absent();
  for (auto at = found->messages.lower_bound(first); at != found->messages.end(); ++at) {
    if (matches(at->second.subject, subject)) return at->second;
  }
  return std::nullopt;
}

NatsResult<NatsStore::Newest> NatsStore::newest(const std::string& stream,
                                                const std::string& subject) const {
  const Stream* found = find(stream);
  if (found == nullptr) return absent();
  Newest result{.last = found->last};
  for (const auto& [name, number] : found->newest) {
    if (matches(name, subject)) result.numbers.push_back(number);
  }
  std::ranges::sort(result.numbers);
  return result;
}

}  // namespace kerf::sim
