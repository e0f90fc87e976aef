// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon/frame_feed.h"

#include <exception>
#include <utility>

#include "base/start_thread.h"
#include "bridges/frames/planes.h"

namespace disparityd::web {
namespace {

using disparity::Frame;
using disparity::Product;
using disparity::ReadResult;
using frames::leave_out_broken_planes;
using std::chrono::milliseconds;

constexpr milliseconds read_patience{500};  ///< so long a change of the wants may wait for a frame that does not come
constexpr milliseconds pause_after_error{500};

disparity::Subscription subscription_to(const std::set<Product>& products) {
    disparity::Subscription subscription;
    subscription.products.assign(products.begin(), products.end());
    return subscription;
}

}  // namespace

FrameFeed::FrameFeed(DaemonAddress daemon, std::function<void()> on_frame)
    : daemon_(std::move(daemon)), on_frame_(std::move(on_frame)), thread_(base::start_thread([this] { run(); })) {}

FrameFeed::~FrameFeed() {
    stop();
    thread_.join();
}

void FrameFeed::stop() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
}

void FrameFeed::want(const std::set<Product>& products) {
    {
        const std::lock_guard lock(mutex_);
        wanted_ = products;
    }
    changed_.notify_all();
}

std::shared_ptr<const LiveFrame> FrameFeed::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(newest_, nullptr);
}

void FrameFeed::run() {
    for (;;) {
        const std::set<Product> wanted = wait_for_wants();
        if (wanted.empty()) {
            return;
        }
        try {
            if (serve(wanted)) {
                continue;
            }
        } catch (const std::exception&) {
            // The state of the daemon is the status' business: it says why there is none, or no such product.
        }
        if (!pause()) {
            return;
        }
    }
}

/// Returns false when the daemon is gone, true when nobody wants anything: a socket that is not read would be called
/// slow.
bool FrameFeed::serve(std::set<Product> wanted) {
    disparity::Client client = daemon_.connect("frames", subscription_to(wanted));
    for (;;) {
        if (std::set<Product> now = wants(); now != wanted) {
            if (now.empty()) {
                return true;
            }
            client.subscribe(subscription_to(now));
            wanted = std::move(now);
        }
        Frame frame;
        switch (client.read(frame, read_patience)) {
            case ReadResult::frame: hand_over(std::move(frame)); break;
            case ReadResult::timeout: break;
            case ReadResult::gone: return false;
        }
    }
}

/// Returns what is wanted now; nothing when the feed ends.
std::set<Product> FrameFeed::wants() {
    const std::lock_guard lock(mutex_);
    return stop_ ? std::set<Product>() : wanted_;
}

/// Returns what is wanted, at once when something is; nothing when the feed ends.
std::set<Product> FrameFeed::wait_for_wants() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return stop_ || !wanted_.empty(); });
    return stop_ ? std::set<Product>() : wanted_;
}

/// Returns false when the feed ends.
bool FrameFeed::pause() {
    std::unique_lock lock(mutex_);
    return !changed_.wait_for(lock, pause_after_error, [this] { return stop_; });
}

void FrameFeed::hand_over(Frame&& frame) {
    leave_out_broken_planes(frame);
    auto live = std::make_shared<LiveFrame>();
    live->frame = std::move(frame);
    live->received = std::chrono::steady_clock::now();
    bool first = false;
    {
        const std::lock_guard lock(mutex_);
        first = newest_ == nullptr;
        newest_ = std::move(live);
    }
    if (first) {
        on_frame_();
    }
}

}  // namespace disparityd::web
