// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/server_machine.h"

#include <utility>

#include "tests/sim/os/descriptors.h"

namespace kerf::sim {

ServerMachine::ServerMachine(std::string name, net::ServerOptions options,
                             std::filesystem::path root, double clock_rate)
    : name_(std::move(name)),
      options_(std::move(options)),
      root_(std::move(root)),
      clock_rate_(clock_rate),
      wall_ns_(1'800'000'000 * kSecond) {
  std::filesystem::create_directories(root_ / "disk0");
  disk_ = std::make_unique<Disk>(root_ / "disk0");
}

void ServerMachine::run(Process& process, net::ServerOptions options) const {
  auto server = net::Server::create(std::move(options));
  if (!server) {
    process.failure = server.error();
    return;
  }
  if (const auto listens = (*server)->listen(); !listens) {
    process.failure = listens.error();
    return;
  }
  process.server = server->get();
  {
    std::unique_lock lock(process.mutex);
    process.changed.wait(lock, [&] { return process.is_asked_to_stop; });
  }
  process.server = nullptr;
}

void ServerMachine::start() {
  if (process_) return;
  // Each run has a machine of its own, because the threads of one that was killed stay with theirs.
  auto machine = std::make_unique<Machine>();
  machine->name = name_ + std::to_string(++starts_);
  machine->boot_ns = static_cast<Time>(draw(1'000'000)) * kMillisecond;
  machine->rate = clock_rate_;
  machine->wall_ns = wall_ns_ - machine->boot_ns;
  if (machine_) (void)machine_.release();  // NOLINT: its threads may still name it
  machine_ = std::move(machine);
  net::ServerOptions options = options_;
  options.http.data_folder = disk_->folder() / "data";
  process_ = std::make_unique<Process>();
  enter(machine_.get());
  process_->thread =
      std::thread([this, process = process_.get(), options = std::move(options)]() mutable {
        run(*process, std::move(options));
      });
  enter(nullptr);
}

void ServerMachine::stop() {
  if (!process_) return;
  {
    const std::lock_guard lock(process_->mutex);
    process_->is_asked_to_stop = true;
  }
  process_->changed.notify_all();
  process_->thread.join();
  process_.reset();
}

void ServerMachine::kill(bool power_loss) {
  if (!process_) return;
  end_threads_of(*machine_);
  process_->thread.detach();
  (void)process_.release();  // NOLINT: its threads have it, for ever
  const auto folder = root_ / ("disk" + std::to_string(++disks_));
  if (power_loss) {
    disk_->copy_after_power_loss(folder);
  } else {
    disk_->copy_to(folder);
  }
  disk_ = std::make_unique<Disk>(folder);
}

void ServerMachine::stand_still(Time length) { machine_->stands_until = now() + length; }
void ServerMachine::cut_connections() { Descriptors::instance().cut_those_of(*machine_); }
void ServerMachine::set_clock(Time by) {
  wall_ns_ += by;
  machine_->wall_ns += by;
}

}  // namespace kerf::sim
