// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon/status_feed.h"

#include <exception>
#include <stdexcept>
#include <utility>

#include "base/start_thread.h"

namespace disparityd::web {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds interval{500};
constexpr milliseconds pause_between_sensors{50};
constexpr milliseconds status_patience{2000};  ///< a daemon that does not answer so long is told to hang

std::shared_ptr<const v1::Status> ask(disparity::SocketClient& client) {
    auto status = std::make_shared<v1::Status>();
    if (!status->ParseFromString(client.status(status_patience))) {
        throw std::runtime_error("the daemon's status is damaged or of another version");
    }
    return status;
}

/// Whether the daemon surely serves the same products: a new connection is told which. A new configuration begins to
/// count anew.
bool same_set_up(const v1::Status& a, const v1::Status& b) {
    return a.state() == b.state() && a.source() == b.source() && a.method() == b.method() &&
           a.geometry().SerializeAsString() == b.geometry().SerializeAsString() && a.uptime_s() <= b.uptime_s() &&
           a.captured() <= b.captured() && a.published() <= b.published();
}

}  // namespace

StatusFeed::StatusFeed(DaemonAddress daemon, std::function<void(DaemonState)> on_state,
                       std::function<void(disparity::SensorBatch)> on_sensors)
    : daemon_(std::move(daemon)),
      on_state_(std::move(on_state)),
      on_sensors_(std::move(on_sensors)),
      thread_(base::start_thread([this] { run(); })) {}

StatusFeed::~StatusFeed() {
    stop();
    thread_.join();
}

void StatusFeed::stop() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
}

void StatusFeed::want_sensors(bool wanted) {
    const std::lock_guard lock(mutex_);
    sensors_ = wanted;
}

void StatusFeed::run() {
    do {
        try {
            serve();
        } catch (const std::exception& error) {
            on_state_({false, error.what(), nullptr, {}});
        }
    } while (wait(interval));
}

/// Returns when the feed ends; throws when the daemon is gone.
void StatusFeed::serve() {
    disparity::SocketClient client = daemon_.connect("status");
    DaemonState state{true, {}, nullptr, welcome_of(client).products};
    bool sensors = false;
    auto next = steady_clock::now();
    do {
        if (steady_clock::now() >= next) {
            const auto status = ask(client);
            if (state.status && !same_set_up(*state.status, *status)) {
                client = daemon_.connect("status");
                state.products = welcome_of(client).products;
                sensors = false;
            }
            state.status = status;
            on_state_(state);
            next = steady_clock::now() + interval;
        }
        if (sensors != wants_sensors()) {
            sensors = !sensors;
            disparity::Subscription subscription;
            subscription.products.clear();
            subscription.sensors = sensors;
            client.subscribe(subscription);
        }
        disparity::SensorBatch batch;
        if (sensors && client.read_sensors(batch, milliseconds(0)) == disparity::ReadResult::frame) {
            on_sensors_(std::move(batch));
        }
    } while (wait(sensors ? pause_between_sensors : interval));
}

/// Returns false when the feed ends.
bool StatusFeed::wait(milliseconds time) {
    std::unique_lock lock(mutex_);
    return !changed_.wait_for(lock, time, [this] { return stop_; });
}

bool StatusFeed::wants_sensors() {
    const std::lock_guard lock(mutex_);
    return sensors_;
}

}  // namespace disparityd::web
