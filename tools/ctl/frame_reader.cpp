// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/frame_reader.h"

#include <stdexcept>
#include <utility>

#include "proto/monotonic_clock.h"

namespace disparityd::tools {
namespace {

using disparity::Frame;
using disparity::Product;
using disparity::ReadResult;

class SharedMemoryFrames final : public FrameReader {
public:
    SharedMemoryFrames(const std::string& name, std::vector<Product> products)
        : reader_(name), name_(name), products_(std::move(products)) {}

    ReadResult read(Frame& frame, std::chrono::milliseconds timeout) override {
        return reader_.read(frame, timeout, products_);
    }
    bool local() const override { return true; }
    std::string where() const override { return "shared memory " + name_; }

private:
    disparity::SharedMemoryReader reader_;
    std::string name_;
    std::vector<Product> products_;
};

class SocketFrames final : public FrameReader {
public:
    SocketFrames(const DaemonAddress& daemon, const std::vector<Product>& products)
        : client_(connect(daemon)), local_(daemon.socket.empty() || is_local(daemon.sockets().usable.front().address)) {
        disparity::Subscription subscription;
        subscription.products = products;
        client_.subscribe(subscription);
    }

    ReadResult read(Frame& frame, std::chrono::milliseconds timeout) override { return client_.read(frame, timeout); }
    bool local() const override { return local_; }
    std::string where() const override { return "socket"; }

private:
    disparity::SocketClient client_;
    bool local_;
};

}  // namespace

std::unique_ptr<FrameReader> open_frames(const DaemonAddress& daemon, const std::vector<Product>& products) {
    if (!daemon.socket.empty()) {
        return std::make_unique<SocketFrames>(daemon, products);
    }
    std::string why;
    try {
        return std::make_unique<SharedMemoryFrames>(daemon.name, products);
    } catch (const std::runtime_error& error) {
        why = error.what();
    }
    try {
        return std::make_unique<SocketFrames>(daemon, products);
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(std::string(error.what()) + " (" + why + ")");
    }
}

std::int64_t age_ns(const Frame& frame, bool local) {
    // A replayed frame has the time of its recording, and a port of this machine may lead to another machine: this
    // clock counts only where it agrees with the age that the daemon sent.
    constexpr std::int64_t plausible_ns = 5'000'000'000;
    const std::int64_t by_our_clock = proto::monotonic_ns() - frame.monotonic_ns;
    const std::int64_t on_the_way = by_our_clock - frame.age_ns;
    return local && on_the_way >= 0 && on_the_way < plausible_ns ? by_our_clock : frame.age_ns;
}

}  // namespace disparityd::tools
