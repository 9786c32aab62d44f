// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace kerf {

enum class NatsErrorCode : std::uint8_t {
  kAway,          ///< no connection, or no answer in time: the outcome is unknown
  kNotNext,       ///< the stream has other messages than the publisher assumes; nothing was stored
  kAbsent,        ///< the stream does not exist
  kRefused,       ///< the server rejects it, e.g. because JetStream is off
  kNotSupported,  ///< built without libnats
};

struct NatsError {
  NatsErrorCode code = NatsErrorCode::kAway;
  std::string reason;  ///< one sentence
};
template <typename T>
using NatsResult = std::expected<T, NatsError>;

/// A message of a stream.
struct StreamMessage {
  std::uint64_t sequence = 0;  ///< in the stream, from 1
  std::vector<std::byte> bytes;
  std::string subject = {};
};

/// The newest message of each subject of a stream, then each later one. For one thread.
class NatsWatch {
 public:
  NatsWatch(NatsWatch&&) noexcept;
  NatsWatch& operator=(NatsWatch&&) noexcept;
  ~NatsWatch();
  /// The next message, or nullopt after `wait` without one. Must not be used after an error.
  NatsResult<std::optional<StreamMessage>> next(std::chrono::milliseconds wait);

 private:
  friend class NatsConnection;
  struct Impl;
  explicit NatsWatch(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Calls a function with each message of a subject, on a thread of its own, while this object
/// exists. Its destructor waits for the last call. Such messages are in no stream, and are lost
/// without a connection.
class NatsListener {
 public:
  NatsListener();  ///< receives no messages
  NatsListener(NatsListener&&) noexcept;
  NatsListener& operator=(NatsListener&&) noexcept;
  ~NatsListener();

 private:
  friend class NatsConnection;
  struct Impl;
  explicit NatsListener(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Messages that a stream keeps.
enum class Keep : std::uint8_t { kAll, kLastOfSubject };

/// A connection to NATS, and streams of JetStream, each with one subject or, with a wildcard, all
/// that match it. It connects and reconnects by itself, without end. Meanwhile calls fail with
/// kAway. Thread-safe.
class NatsConnection {
 public:
  /// `url` is one server or several equivalent ones (nats_address.h). Waits at most 2 s for the
  /// connection, and keeps trying without one. The error is an invalid URL, or kNotSupported.
  static NatsResult<NatsConnection> open(const std::string& url, const std::string& name);
  NatsConnection(NatsConnection&&) noexcept;
  NatsConnection& operator=(NatsConnection&&) noexcept;
  ~NatsConnection();

  bool is_connected() const;
  /// Makes a stream on the disk of `replicas` servers, unless it exists.
  NatsResult<void> make_stream(const std::string& stream, const std::string& subject, int replicas,
                               Keep keep = Keep::kAll);
  /// The last message of a stream, or nullopt if it is empty. kAbsent without the stream.
  NatsResult<std::optional<StreamMessage>> last_message(const std::string& stream,
                                                        const std::string& subject);
  /// Stores a message as the next one of its subject after `after` (0: as the first), and returns
  /// its number. A message whose `id` was stored within the last two minutes is not stored again.
  NatsResult<std::uint64_t> publish(const std::string& subject, std::span<const std::byte> bytes,
                                    const std::string& id, std::uint64_t after,
                                    std::chrono::milliseconds wait = std::chrono::seconds(2));
  NatsResult<NatsWatch> watch(const std::string& stream, const std::string& subject);
  /// Each message of a stream from number `first` on.
  NatsResult<NatsWatch> watch_from(const std::string& stream, const std::string& subject,
                                   std::uint64_t first);
  /// Sends a message to the current listeners of a subject that belongs to no stream. Dropped
  /// without a connection.
  void send(const std::string& subject, std::span<const std::byte> bytes);
  /// `subject` may have wildcards. The connection must outlive the result.
  NatsResult<NatsListener> listen(const std::string& subject,
                                  std::function<void(const StreamMessage&)> take);
  /// Calls `take` with each message of a stream, from the first to the present last one. Ends early
  /// when it returns false.
  NatsResult<void> read(const std::string& stream, const std::string& subject,
                        const std::function<bool(StreamMessage)>& take);
  /// The names of all streams.
  NatsResult<std::vector<std::string>> streams();
  /// Deletes the messages of a stream before number `first`.
  NatsResult<void> purge(const std::string& stream, std::uint64_t first);
  NatsResult<void> delete_stream(const std::string& stream);

 private:
  struct Impl;
  explicit NatsConnection(std::unique_ptr<Impl> impl);
  NatsResult<NatsWatch> watch_since(const std::string& stream, const std::string& subject,
                                    std::uint64_t first);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
