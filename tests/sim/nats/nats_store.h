// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/cluster/nats_connection.h"

namespace kerf::sim {

/// Whether a subject matches a pattern of NATS: "*" is any one word, ">" the rest.
bool matches(std::string_view subject, std::string_view pattern);

/// The streams of a nats-server with JetStream, as Kerf uses them. It is a value, so that a server
/// can return with an earlier state.
class NatsStore {
 public:
  using Clock = std::chrono::steady_clock;
  /// A message whose id was stored within this time is not stored again.
  static constexpr std::chrono::minutes kRemembers{2};

  void make(const std::string& stream, const std::string& subject, Keep keep);
  /// False: there is none.
  bool remove(const std::string& stream);
  std::vector<std::string> names() const;
  NatsResult<void> purge(const std::string& stream, std::uint64_t first);
  NatsResult<std::optional<StreamMessage>> last(const std::string& stream,
                                                const std::string& subject) const;
  /// As NatsConnection::publish().
  NatsResult<std::uint64_t> publish(const std::string& subject, std::span<const std::byte> bytes,
                                    const std::string& id, std::uint64_t after,
                                    Clock::time_point now);
  /// Stores a message of which nothing is expected, if a stream has the subject.
  void add(const std::string& subject, std::span<const std::byte> bytes);
  /// The first message from number `first` on whose subject matches; nullopt: there is none yet.
  /// kAbsent without the stream.
  NatsResult<std::optional<StreamMessage>> next(const std::string& stream,
                                                const std::string& subject,
                                                std::uint64_t first) const;
  /// The numbers of the newest messages of the subjects that match, and the number of the last one
  /// of the stream.
  struct Newest {
    std::vector<std::uint64_t> numbers;
    std::uint64_t last = 0;
  };
  NatsResult<Newest> newest(const std::string& stream, const std::string& subject) const;

 private:
  struct Stream {
    std::string subject;
    Keep keep = Keep::kAll;
    std::uint64_t last = 0;
    std::map<std::uint64_t, StreamMessage> messages;
    std::map<std::string, std::uint64_t> newest;  ///< of each subject
    struct Known {
      std::uint64_t sequence = 0;
      Clock::time_point at;
    };
    std::map<std::string, Known> ids;
  };
  const Stream* find(const std::string& stream) const;
  Stream* of_subject(const std::string& subject);
  static std::uint64_t store(Stream& stream, const std::string& subject,
                             std::span<const std::byte> bytes);

  std::map<std::string, Stream> streams_;
};

}  // namespace kerf::sim
