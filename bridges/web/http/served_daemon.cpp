// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/served_daemon.h"

#include <utility>

#include <boost/asio/post.hpp>

namespace disparityd::web {
namespace {

/// Monitoring and lists take the newest status, which so may be this old.
constexpr std::chrono::milliseconds seldom_interval{2000};

}  // namespace

ServedDaemon::ServedDaemon(const ServerParts& parts, const DaemonAddress& address, Unwatched unwatched)
    : unwatched_(unwatched),
      hub_([this](const Wants& wants) { on_wants(wants); }),
      place_{parts, hub_},
      control_(address),
      routes_(place_, control_),
      frames_(address, [this] { boost::asio::post(place_.network, [this] { hub_.on_frame(frames_.take()); }); }),
      statuses_(
          address,
          [this](DaemonState state) {
              boost::asio::post(place_.network, [this, state = std::move(state)] { on_state(state); });
          },
          [this](disparity::SensorBatch batch) {
              boost::asio::post(place_.network, [this, batch = std::move(batch)] { hub_.on_sensors(batch); });
          }) {
    hub_.update_wants();
}

void ServedDaemon::set_present(bool present, const std::string& why) {
    if (present == present_) {
        return;
    }
    present_ = present;
    if (!present_) {
        hub_.on_state({false, why, nullptr, {}});
    }
    hub_.update_wants();
}

void ServedDaemon::stop() {
    frames_.stop();
    statuses_.stop();
}

void ServedDaemon::on_wants(const Wants& wants) {
    frames_.want(wants.products);
    statuses_.want_sensors(wants.sensors);
    const bool seldom = unwatched_ == Unwatched::seldom && !wants.status;
    statuses_.set_interval(!present_ ? StatusFeed::never : seldom ? seldom_interval : StatusFeed::usual_interval);
}

/// A state that was on its way when the daemon went is not told any more.
void ServedDaemon::on_state(const DaemonState& state) {
    if (present_) {
        hub_.on_state(state);
    }
}

}  // namespace disparityd::web
