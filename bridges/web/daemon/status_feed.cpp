// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon/status_feed.h"

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/start_thread.h"

namespace disparityd::web {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds pause_between_sensors{50};
constexpr milliseconds status_patience{2000};  ///< a daemon that does not answer so long is told to hang

std::shared_ptr<const v1::Status> ask(disparity::Client& client) {
    auto status = std::make_shared<v1::Status>();
    if (!status->ParseFromString(client.status(status_patience))) {
        throw std::runtime_error("the daemon's status is damaged or of another version");
    }
    return status;
}

/// Returns what the daemon serves. While it prepares its first source it does not know.
std::vector<disparity::Product> served_products(const v1::Status& status) {
    std::vector<disparity::Product> products;
    for (const int product : status.products()) {
        products.push_back(static_cast<disparity::Product>(product));
    }
    return products;
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

void StatusFeed::set_interval(milliseconds interval) {
    {
        const std::lock_guard lock(mutex_);
        interval_ = interval;
    }
    changed_.notify_all();
}

void StatusFeed::run() {
    for (auto asked = steady_clock::time_point(); wait_until_due(asked);) {
        try {
            serve();
        } catch (const std::exception& error) {
            on_state_({false, error.what(), nullptr, {}});
        }
        asked = steady_clock::now();
    }
}

/// Returns when the feed ends or the daemon is to be left alone; throws when the daemon is gone.
void StatusFeed::serve() {
    disparity::Client client = daemon_.connect("status", no_frames());
    DaemonState state{true, {}, nullptr, {}};
    bool sensors = false;
    steady_clock::time_point asked;
    for (auto begin = asked; rest(begin, sensors);) {
        begin = steady_clock::now();
        if (const milliseconds pause = interval(); pause != never && begin >= asked + pause) {
            state.status = ask(client);
            state.products = served_products(*state.status);
            on_state_(state);
            asked = begin;
        }
        if (sensors != wants_sensors()) {
            sensors = !sensors;
            disparity::Subscription subscription = no_frames();
            subscription.sensors = sensors;
            client.subscribe(subscription);
        }
        disparity::SensorBatch batch;
        if (sensors && client.read_sensors(batch, milliseconds(0)) == disparity::ReadResult::frame) {
            on_sensors_(std::move(batch));
        }
    }
}

/// Waits until the status is due, as long as the daemon is left alone. Returns false when the feed ends.
bool StatusFeed::wait_until_due(steady_clock::time_point asked) {
    std::unique_lock lock(mutex_);
    while (!stop_ && (interval_ == never || steady_clock::now() < asked + interval_)) {
        if (interval_ == never) {
            changed_.wait(lock);
        } else {
            changed_.wait_until(lock, asked + interval_);
        }
    }
    return !stop_;
}

/// Waits until the interval has passed, or a shorter one where sensors are read. Returns false when the feed ends or
/// the daemon is to be left alone.
bool StatusFeed::rest(steady_clock::time_point begin, bool sensors) {
    std::unique_lock lock(mutex_);
    const auto pause = [&] { return sensors ? std::min(interval_, pause_between_sensors) : interval_; };
    while (!stop_ && interval_ != never && steady_clock::now() < begin + pause()) {
        changed_.wait_until(lock, begin + pause());
    }
    return !stop_ && interval_ != never;
}

milliseconds StatusFeed::interval() {
    const std::lock_guard lock(mutex_);
    return interval_;
}

bool StatusFeed::wants_sensors() {
    const std::lock_guard lock(mutex_);
    return sensors_;
}

}  // namespace disparityd::web
