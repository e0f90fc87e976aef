// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/side_feed.h"

#include <exception>
#include <utility>

#include "base/start_thread.h"
#include "bridges/program/waiting_client.h"

namespace disparityd::ros2 {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds wait_for_samples{100};
constexpr milliseconds pause_after_error{500};
constexpr milliseconds status_period{1000};

disparity::Subscription subscription_to(bool samples) {
    disparity::Subscription subscription;
    subscription.products.clear();
    subscription.sensors = samples;
    return subscription;
}

}  // namespace

SideFeed::SideFeed(std::string where, disparity::ClientOptions options, Takers takers)
    : where_(std::move(where)),
      options_(bridges::waiting_for_the_daemon(std::move(options))),
      takers_(std::move(takers)) {
    const disparity::Client refuses_other_names(where_, subscription_to(false), options_);
    thread_ = base::start_thread([this] { run(); });
}

SideFeed::~SideFeed() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void SideFeed::want_samples(bool wanted) {
    {
        const std::lock_guard lock(mutex_);
        if (samples_ == wanted) {
            return;
        }
        samples_ = wanted;
    }
    changed_.notify_all();
}

bool SideFeed::wants_samples() {
    const std::lock_guard lock(mutex_);
    return samples_;
}

/// Returns false when the feed ends.
bool SideFeed::wait(milliseconds time) {
    std::unique_lock lock(mutex_);
    const bool samples = samples_;
    changed_.wait_for(lock, time, [&] { return stop_ || samples_ != samples; });
    return !stop_;
}

void SideFeed::run() {
    do {
        try {
            serve();
            return;
        } catch (const std::exception& error) {
            takers_.away(error.what());
        }
    } while (wait(pause_after_error));
}

/// Returns when the feed ends; throws what a daemon or its absence does.
void SideFeed::serve() {
    bool samples = wants_samples();
    disparity::Client client(where_, subscription_to(samples), options_);
    steady_clock::time_point next_status{};
    do {
        if (steady_clock::now() >= next_status) {
            takers_.status(client.status(options_.timeout));
            next_status = steady_clock::now() + status_period;
        }
        if (const bool now = wants_samples(); now != samples) {
            client.subscribe(subscription_to(now));
            samples = now;
        }
        disparity::SensorBatch batch;
        if (samples && client.read_sensors(batch, wait_for_samples) == disparity::ReadResult::frame) {
            takers_.samples(batch);
        }
    } while (wait(samples ? milliseconds(0) : wait_for_samples));
}

}  // namespace disparityd::ros2
