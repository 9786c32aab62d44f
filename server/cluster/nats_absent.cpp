// SPDX-License-Identifier: Apache-2.0
// NatsConnection of a program built without libnats: open() always fails.
#include "server/cluster/nats_connection.h"

namespace kerf {
namespace {

std::unexpected<NatsError> not_supported() {
  return std::unexpected(NatsError{NatsErrorCode::kNotSupported,
                                   "this kerf-server was built without libnats: install "
                                   "libnats-dev and build it again"});
}

}  // namespace

struct NatsConnection::Impl {};

NatsConnection::NatsConnection(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
NatsConnection::NatsConnection(NatsConnection&&) noexcept = default;
NatsConnection& NatsConnection::operator=(NatsConnection&&) noexcept = default;
NatsConnection::~NatsConnection() = default;

NatsResult<NatsConnection> NatsConnection::open(const std::string&, const std::string&) {
  return not_supported();
}
bool NatsConnection::is_connected() const { return false; }
NatsResult<void> NatsConnection::make_stream(const std::string&, const std::string&, int, Keep) {
  return not_supported();
}
NatsResult<std::optional<StreamMessage>> NatsConnection::last_message(const std::string&,
                                                                      const std::string&) {
  return not_supported();
}
NatsResult<std::uint64_t> NatsConnection::publish(const std::string&, std::span<const std::byte>,
                                                  const std::string&, std::uint64_t,
                                                  std::chrono::milliseconds) {
  return not_supported();
}

struct NatsWatch::Impl {};
NatsWatch::NatsWatch(NatsWatch&&) noexcept = default;
NatsWatch& NatsWatch::operator=(NatsWatch&&) noexcept = default;
NatsWatch::~NatsWatch() = default;
NatsResult<std::optional<StreamMessage>> NatsWatch::next(std::chrono::milliseconds) {
  return not_supported();
}
NatsResult<NatsWatch> NatsConnection::watch(const std::string&, const std::string&) {
  return not_supported();
}
NatsResult<NatsWatch> NatsConnection::watch_from(const std::string&, const std::string&,
                                                 std::uint64_t) {
  return not_supported();
}

struct NatsListener::Impl {};
NatsListener::NatsListener() = default;
NatsListener::NatsListener(NatsListener&&) noexcept = default;
NatsListener& NatsListener::operator=(NatsListener&&) noexcept = default;
NatsListener::~NatsListener() = default;
void NatsConnection::send(const std::string&, std::span<const std::byte>) {}
NatsResult<NatsListener> NatsConnection::listen(const std::string&,
                                                std::function<void(const StreamMessage&)>) {
  return not_supported();
}
NatsResult<void> NatsConnection::read(const std::string&, const std::string&,
                                      const std::function<bool(StreamMessage)>&) {
  return not_supported();
}
NatsResult<std::vector<std::string>> NatsConnection::streams() { return not_supported(); }
NatsResult<void> NatsConnection::purge(const std::string&, std::uint64_t) {
  return not_supported();
}
NatsResult<void> NatsConnection::delete_stream(const std::string&) { return not_supported(); }

}  // namespace kerf
