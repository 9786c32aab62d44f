// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/nats_connection.h"

#include <nats/nats.h>

#include <array>
#include <chrono>
#include <future>
#include <thread>
#include <utility>
#include <vector>

#include "server/cluster/nats_address.h"
#include "server/cluster/nats_line.h"
#include "server/platform/clock.h"

namespace kerf {
namespace {

constexpr std::int64_t kWaitMs = 2000;
constexpr std::int64_t kReconnectMs = 250, kPingMs = 2000;
constexpr std::chrono::milliseconds kConnectPoll{5};

template <typename T, void (*Destroy)(T*)>
struct Owner {
  void operator()(T* object) const { Destroy(object); }
};
template <typename T, void (*Destroy)(T*)>
using Owned = std::unique_ptr<T, Owner<T, Destroy>>;
using Options = Owned<natsOptions, natsOptions_Destroy>;
using Message = Owned<natsMsg, natsMsg_Destroy>;

std::unexpected<NatsError> failed(natsStatus status, jsErrCode code) {
  auto kind = NatsErrorCode::kAway;
  if (code == JSStreamWrongLastSequenceErr) kind = NatsErrorCode::kNotNext;
  if (code == JSStreamNotFoundErr) kind = NatsErrorCode::kAbsent;
  if (kind == NatsErrorCode::kAway && code != 0) kind = NatsErrorCode::kRefused;
  // Without JetStream its subjects have no listener.
  if (status == NATS_NO_RESPONDERS) kind = NatsErrorCode::kRefused;
  std::string reason = std::string("NATS: ") + natsStatus_GetText(status);
  if (kind == NatsErrorCode::kAway) reason = "NATS cannot be reached: " + reason.substr(6);
  if (status == NATS_NO_RESPONDERS) {
    reason = "JetStream does not answer: is nats-server started with -js?";
  }
  if (code != 0) reason += " (JetStream error " + std::to_string(code) + ")";
  return std::unexpected(NatsError{kind, std::move(reason)});
}

StreamMessage take(natsMsg* message) {
  const auto* data = reinterpret_cast<const std::byte*>(natsMsg_GetData(message));
  const auto size = static_cast<std::size_t>(natsMsg_GetDataLength(message));
  return {natsMsg_GetSequence(message), {data, data + size}, natsMsg_GetSubject(message)};
}

/// The same for a message of a subscription, which has its numbers elsewhere.
NatsResult<StreamMessage> take_delivered(natsMsg* message) {
  jsMsgMetaData* place = nullptr;
  const natsStatus status = natsMsg_GetMetaData(&place, message);
  if (status != NATS_OK) return failed(status, jsErrCode{});
  StreamMessage taken = take(message);
  taken.sequence = place->Sequence.Stream;
  jsMsgMetaData_Destroy(place);
  return taken;
}

}  // namespace

struct NatsConnection::Impl {
  std::shared_ptr<NatsLine> line = std::make_shared<NatsLine>();

  natsConnection* connection() const { return line->connection.get(); }
  jsCtx* streams() const { return line->streams.get(); }
};

NatsConnection::NatsConnection(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
NatsConnection::NatsConnection(NatsConnection&&) noexcept = default;
NatsConnection& NatsConnection::operator=(NatsConnection&&) noexcept = default;
NatsConnection::~NatsConnection() = default;

NatsResult<NatsConnection> NatsConnection::open(const std::string& url, const std::string& name) {
  std::vector<std::string> servers = nats_servers(url);
  std::vector<const char*> addresses;
  for (const std::string& server : servers) addresses.push_back(server.c_str());
  natsOptions* raw = nullptr;
  natsStatus status = natsOptions_Create(&raw);
  const Options options(raw);
  const auto set = [&](natsStatus done) {
    if (status == NATS_OK) status = done;
  };
  if (status == NATS_OK) {
    set(natsOptions_SetServers(raw, addresses.data(), static_cast<int>(addresses.size())));
    set(natsOptions_SetName(raw, name.c_str()));
    set(natsOptions_SetSendAsap(raw, true));  // otherwise a message waits for up to 1 ms
    set(natsOptions_SetMaxReconnect(raw, -1));
    set(natsOptions_SetReconnectWait(raw, kReconnectMs));
    set(natsOptions_SetPingInterval(raw, kPingMs));
    // Returns at once. Otherwise a failed first attempt would be final.
    const auto ignore = [](natsConnection*, void*) {};
    set(natsOptions_SetRetryOnFailedConnect(raw, true, ignore, nullptr));
  }
  auto impl = std::make_unique<Impl>();
  natsConnection* connection = nullptr;
  if (status == NATS_OK) {
    status = natsConnection_Connect(&connection, raw);
    if (status == NATS_NOT_YET_CONNECTED) status = NATS_OK;
    impl->line->connection.reset(connection);
  }
  jsCtx* streams = nullptr;
  if (status == NATS_OK) {
    jsOptions js;
    jsOptions_Init(&js);
    js.Wait = kWaitMs;
    status = natsConnection_JetStream(&streams, connection, &js);
    impl->line->streams.reset(streams);
  }
  if (status != NATS_OK) return failed(status, jsErrCode{});
  NatsConnection made(std::move(impl));
  const auto end = Clock::now() + std::chrono::milliseconds(kWaitMs);
  while (!made.is_connected() && Clock::now() < end) {
    std::this_thread::sleep_for(kConnectPoll);
  }
  return made;
}

bool NatsConnection::is_connected() const {
  return natsConnection_Status(impl_->connection()) == NATS_CONN_STATUS_CONNECTED;
}

NatsResult<void> NatsConnection::make_stream(const std::string& stream, const std::string& subject,
                                             int replicas, Keep keep) {
  // Otherwise a request would wait in the client for a connection, and be sent late.
  if (!is_connected()) return failed(NATS_NOT_YET_CONNECTED, jsErrCode{});
  jsErrCode code{};
  jsStreamInfo* info = nullptr;
  const natsStatus known =
      js_GetStreamInfo(&info, impl_->streams(), stream.c_str(), nullptr, &code);
  jsStreamInfo_Destroy(info);
  if (known == NATS_OK) return {};
  if (code != JSStreamNotFoundErr) return failed(known, code);
  jsStreamConfig config;
  jsStreamConfig_Init(&config);
  std::array<const char*, 1> subjects = {subject.c_str()};
  config.Name = stream.c_str();
  config.Subjects = subjects.data();
  config.SubjectsLen = 1;
  config.Storage = js_FileStorage;
  config.Replicas = replicas;
  if (keep == Keep::kLastOfSubject) config.MaxMsgsPerSubject = 1;
  const natsStatus status = js_AddStream(nullptr, impl_->streams(), &config, nullptr, &code);
  if (status != NATS_OK) return failed(status, code);
  return {};
}

NatsResult<std::optional<StreamMessage>> NatsConnection::last_message(const std::string& stream,
                                                                      const std::string& subject) {
  if (!is_connected()) return failed(NATS_NOT_YET_CONNECTED, jsErrCode{});
  natsMsg* raw = nullptr;
  jsErrCode code{};
  const natsStatus status =
      js_GetLastMsg(&raw, impl_->streams(), stream.c_str(), subject.c_str(), nullptr, &code);
  const Message message(raw);
  if (code == JSNoMessageFoundErr) return std::nullopt;
  if (status != NATS_OK) return failed(status, code);
  return take(raw);
}

NatsResult<std::uint64_t> NatsConnection::publish(const std::string& subject,
                                                  std::span<const std::byte> bytes,
                                                  const std::string& id, std::uint64_t after,
                                                  std::chrono::milliseconds wait) {
  if (!is_connected()) return failed(NATS_NOT_YET_CONNECTED, jsErrCode{});
  jsPubOptions options;
  jsPubOptions_Init(&options);
  options.MaxWait = wait.count();
  options.MsgId = id.c_str();
  options.ExpectLastSubjectSeq = after;
  options.ExpectNoMessage = after == 0;
  jsPubAck* ack = nullptr;
  jsErrCode code{};
  const natsStatus status = js_Publish(&ack, impl_->streams(), subject.c_str(), bytes.data(),
                                       static_cast<int>(bytes.size()), &options, &code);
  const std::uint64_t sequence = ack == nullptr ? 0 : ack->Sequence;
  jsPubAck_Destroy(ack);
  if (status != NATS_OK) return failed(status, code);
  return sequence;
}

NatsResult<void> NatsConnection::read(const std::string& stream, const std::string& subject,
                                      const std::function<bool(StreamMessage)>& take_message) {
  const auto last = last_message(stream, subject);
  if (!last) return std::unexpected(last.error());
  if (!*last) return {};
  jsSubOptions options;
  jsSubOptions_Init(&options);
  options.Stream = stream.c_str();
  options.Ordered = true;
  natsSubscription* raw = nullptr;
  jsErrCode code{};
  natsStatus status =
      js_SubscribeSync(&raw, impl_->streams(), subject.c_str(), nullptr, &options, &code);
  const NatsSubscription subscription(impl_->line, raw);
  if (status != NATS_OK) return failed(status, code);
  for (std::uint64_t sequence = 0; sequence < (*last)->sequence;) {
    natsMsg* next = nullptr;
    status = natsSubscription_NextMsg(&next, raw, kWaitMs);
    const Message message(next);
    if (status != NATS_OK) return failed(status, jsErrCode{});
    auto taken = take_delivered(next);
    if (!taken) return std::unexpected(taken.error());
    sequence = taken->sequence;
    if (!take_message(*std::move(taken))) return {};
  }
  return {};
}

struct NatsWatch::Impl {
  NatsSubscription subscription;
};

NatsWatch::NatsWatch(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
NatsWatch::NatsWatch(NatsWatch&&) noexcept = default;
NatsWatch& NatsWatch::operator=(NatsWatch&&) noexcept = default;
NatsWatch::~NatsWatch() = default;

NatsResult<NatsWatch> NatsConnection::watch(const std::string& stream, const std::string& subject) {
  return watch_since(stream, subject, 0);
}

NatsResult<NatsWatch> NatsConnection::watch_from(const std::string& stream,
                                                 const std::string& subject, std::uint64_t first) {
  return watch_since(stream, subject, first);
}

/// From message `first` on (0: from the last message of each subject on).
NatsResult<NatsWatch> NatsConnection::watch_since(const std::string& stream,
                                                  const std::string& subject, std::uint64_t first) {
  if (!is_connected()) return failed(NATS_NOT_YET_CONNECTED, jsErrCode{});
  jsSubOptions options;
  jsSubOptions_Init(&options);
  options.Stream = stream.c_str();
  options.Ordered = true;
  options.Config.DeliverPolicy = first == 0 ? js_DeliverLastPerSubject : js_DeliverByStartSequence;
  options.Config.OptStartSeq = first;
  natsSubscription* raw = nullptr;
  jsErrCode code{};
  const natsStatus status =
      js_SubscribeSync(&raw, impl_->streams(), subject.c_str(), nullptr, &options, &code);
  if (status != NATS_OK) return failed(status, code);
  return NatsWatch(
      std::make_unique<NatsWatch::Impl>(NatsWatch::Impl{NatsSubscription(impl_->line, raw)}));
}

struct NatsListener::Impl {
  std::function<void(const StreamMessage&)> take;
  NatsSubscription subscription;
  std::future<void> ended;
};

NatsListener::NatsListener(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
NatsListener::NatsListener() = default;
NatsListener::NatsListener(NatsListener&&) noexcept = default;
NatsListener& NatsListener::operator=(NatsListener&&) noexcept = default;
NatsListener::~NatsListener() {
  if (!impl_ || impl_->subscription.get() == nullptr) return;
  natsSubscription_Unsubscribe(impl_->subscription.get());
  impl_->ended.wait();  // no call is running or will come
}

void NatsConnection::send(const std::string& subject, std::span<const std::byte> bytes) {
  if (!is_connected()) return;
  (void)natsConnection_Publish(impl_->connection(), subject.c_str(), bytes.data(),
                               static_cast<int>(bytes.size()));
}

NatsResult<NatsListener> NatsConnection::listen(const std::string& subject,
                                                std::function<void(const StreamMessage&)> take) {
  auto impl = std::make_unique<NatsListener::Impl>();
  impl->take = std::move(take);
  const auto call = [](natsConnection*, natsSubscription*, natsMsg* raw, void* listener) {
    const Message message(raw);
    const auto* data = reinterpret_cast<const std::byte*>(natsMsg_GetData(raw));
    const auto size = static_cast<std::size_t>(natsMsg_GetDataLength(raw));
    static_cast<NatsListener::Impl*>(listener)->take(
        {0, {data, data + size}, natsMsg_GetSubject(raw)});
  };
  natsSubscription* raw = nullptr;
  natsStatus status =
      natsConnection_Subscribe(&raw, impl_->connection(), subject.c_str(), call, impl.get());
  if (status != NATS_OK) return failed(status, jsErrCode{});
  // The subscription's thread has ended, and the waiting thread destroys the rest.
  auto promise = std::make_unique<std::promise<void>>();
  impl->ended = promise->get_future();
  const auto end = [](void* owned) {
    const std::unique_ptr<std::promise<void>> ended(static_cast<std::promise<void>*>(owned));
    ended->set_value();
  };
  status = natsSubscription_SetOnCompleteCB(raw, end, promise.get());
  if (status == NATS_OK) (void)promise.release();
  impl->subscription = NatsSubscription(impl_->line, raw);
  if (status != NATS_OK) {  // nothing would report the end of the last call
    natsSubscription_Unsubscribe(impl->subscription.get());
    (void)impl.release();  // NOLINT: a call may be running
    return failed(status, jsErrCode{});
  }
  return NatsListener(std::move(impl));
}

NatsResult<std::optional<StreamMessage>> NatsWatch::next(std::chrono::milliseconds wait) {
  natsMsg* raw = nullptr;
  const natsStatus status = natsSubscription_NextMsg(&raw, impl_->subscription.get(), wait.count());
  const Message message(raw);
  if (status == NATS_TIMEOUT) return std::nullopt;
  if (status != NATS_OK) return failed(status, jsErrCode{});
  return take_delivered(raw);
}

NatsResult<std::vector<std::string>> NatsConnection::streams() {
  if (!is_connected()) return failed(NATS_NOT_YET_CONNECTED, jsErrCode{});
  jsStreamNamesList* raw = nullptr;
  jsErrCode code{};
  const natsStatus status = js_StreamNames(&raw, impl_->streams(), nullptr, &code);
  const Owned<jsStreamNamesList, jsStreamNamesList_Destroy> list(raw);
  if (status == NATS_NOT_FOUND) return std::vector<std::string>{};
  if (status != NATS_OK) return failed(status, code);
  return std::vector<std::string>(list->List, list->List + list->Count);
}

NatsResult<void> NatsConnection::purge(const std::string& stream, std::uint64_t first) {
  if (first <= 1) return {};  // nats-server would delete all messages
  if (!is_connected()) return failed(NATS_NOT_YET_CONNECTED, jsErrCode{});
  jsOptions options;
  jsOptions_Init(&options);
  options.Stream.Purge.Sequence = first;
  jsErrCode code{};
  const natsStatus status = js_PurgeStream(impl_->streams(), stream.c_str(), &options, &code);
  if (status != NATS_OK) return failed(status, code);
  return {};
}

NatsResult<void> NatsConnection::delete_stream(const std::string& stream) {
  if (!is_connected()) return failed(NATS_NOT_YET_CONNECTED, jsErrCode{});
  jsErrCode code{};
  const natsStatus status = js_DeleteStream(impl_->streams(), stream.c_str(), nullptr, &code);
  if (status != NATS_OK) return failed(status, code);
  return {};
}

}  // namespace kerf
