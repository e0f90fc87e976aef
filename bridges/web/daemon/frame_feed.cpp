// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon/frame_feed.h"

#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

#include "base/start_thread.h"
#include "bridges/web/frames/planes.h"

namespace disparityd::web {
namespace {

using disparity::Frame;
using disparity::Product;
using disparity::ReadResult;
using std::chrono::milliseconds;

constexpr milliseconds read_patience{500};  ///< so long a change of the wants may wait for a frame that does not come
constexpr milliseconds pause_after_error{500};

}  // namespace

/// Reads frames with the products that are wanted, as far as the daemon serves them.
class FrameFeed::Reader {
public:
    virtual ~Reader() = default;
    virtual ReadResult read(Frame& frame, const std::set<Product>& wanted) = 0;
};

class FrameFeed::SharedMemoryFrames final : public FrameFeed::Reader {
public:
    explicit SharedMemoryFrames(const std::string& name) : reader_(name) {}

    ReadResult read(Frame& frame, const std::set<Product>& wanted) override {
        return reader_.read(frame, read_patience, {wanted.begin(), wanted.end()});
    }

private:
    disparity::SharedMemoryReader reader_;
};

class FrameFeed::SocketFrames final : public FrameFeed::Reader {
public:
    SocketFrames(disparity::SocketClient client, const std::vector<Product>& served)
        : client_(std::move(client)), served_(served.begin(), served.end()) {}

    ReadResult read(Frame& frame, const std::set<Product>& wanted) override {
        if (wanted != subscribed_) {
            // The daemon was configured anew since it greeted: ask again what it serves.
            if (!std::includes(served_.begin(), served_.end(), wanted.begin(), wanted.end())) {
                return ReadResult::gone;
            }
            disparity::Subscription subscription;
            subscription.products.assign(wanted.begin(), wanted.end());
            client_.subscribe(subscription);
            subscribed_ = wanted;
        }
        return client_.read(frame, read_patience);
    }

private:
    disparity::SocketClient client_;
    std::set<Product> served_;
    std::set<Product> subscribed_;
};

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
        if (wait_for_wants().empty()) {
            return;
        }
        try {
            const std::unique_ptr<Reader> reader = open();
            if (serve(*reader)) {
                continue;
            }
        } catch (const std::exception&) {
            // The state of the daemon is the status' business: it says why there is none.
        }
        if (!pause()) {
            return;
        }
    }
}

/// Returns false when the daemon is gone, true when nobody wants anything: a socket that is not read would be called
/// slow.
bool FrameFeed::serve(Reader& reader) {
    for (;;) {
        const std::set<Product> wanted = wants();
        if (wanted.empty()) {
            return true;
        }
        Frame frame;
        switch (reader.read(frame, wanted)) {
            case ReadResult::frame: hand_over(std::move(frame)); break;
            case ReadResult::timeout: break;
            case ReadResult::gone: return false;
        }
    }
}

std::unique_ptr<FrameFeed::Reader> FrameFeed::open() const {
    disparity::SocketClient client = daemon_.connect("frames");
    const Welcome welcome = welcome_of(client);
    if (!welcome.shared_memory.empty()) {
        try {
            return std::make_unique<SharedMemoryFrames>(welcome.shared_memory);
        } catch (const std::exception&) {
            // It belongs to a user who is not trusted, or may not be read: the socket serves as well.
        }
    }
    return std::make_unique<SocketFrames>(std::move(client), welcome.products);
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
