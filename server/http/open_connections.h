// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <list>
#include <map>
#include <string>
#include <utility>

namespace kerf::net {

/// The connections that are not WebSockets (yet), by network of the client (network_of). When the
/// server has its maximum number of connections, one of these is closed for each new one.
/// Single-threaded.
class OpenConnections {
  struct Entry {
    std::string network;
    std::function<void()> close;
  };
  using Entries = std::list<Entry>;  ///< oldest first

 public:
  /// The entry of a connection, removed by leave() or its destructor.
  class Place {
   public:
    Place() = default;
    Place(Place&& other) noexcept
        : all_(std::exchange(other.all_, nullptr)), entry_(other.entry_) {}
    Place& operator=(Place&& other) noexcept {
      std::swap(all_, other.all_);
      std::swap(entry_, other.entry_);
      return *this;
    }
    ~Place() { leave(); }
    void leave() {
      if (all_ != nullptr) std::exchange(all_, nullptr)->remove(entry_);
    }

   private:
    friend class OpenConnections;
    Place(OpenConnections* all, Entries::iterator entry) : all_(all), entry_(entry) {}
    OpenConnections* all_ = nullptr;
    Entries::iterator entry_;
  };

  /// Adds a connection. `close` ends it; it is called at most once and does not destroy the place
  /// at once.
  Place enter(std::string network, std::function<void()> close) {
    ++counts_[network];
    entries_.push_back({std::move(network), std::move(close)});
    return {this, std::prev(entries_.end())};
  }
  /// Closes the oldest connection of the network with the most open ones. Returns false if there is
  /// none.
  bool close_one() {
    const auto most =
        std::ranges::max_element(counts_, {}, [](const auto& count) { return count.second; });
    if (most == counts_.end()) return false;
    const std::string network = most->first;
    const auto oldest = std::ranges::find_if(
        entries_, [&](const Entry& entry) { return entry.close && entry.network == network; });
    count_down(network);
    std::exchange(oldest->close, nullptr)();
    return true;
  }

 private:
  void remove(Entries::iterator entry) {
    if (entry->close) count_down(entry->network);
    entries_.erase(entry);
  }
  void count_down(const std::string& network) {
    const auto count = counts_.find(network);
    if (--count->second == 0) counts_.erase(count);
  }

  Entries entries_;
  std::map<std::string, std::size_t> counts_;  ///< of connections not yet closed
};

}  // namespace kerf::net
