// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/frame_reader.h"

#include <stdexcept>
#include <utility>

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
    std::string where() const override { return "shared memory " + name_; }
    bool unanswered() const override { return false; }

private:
    disparity::SharedMemoryReader reader_;
    std::string name_;
    std::vector<Product> products_;
};

class SocketFrames final : public FrameReader {
public:
    SocketFrames(const DaemonAddress& daemon, const std::vector<Product>& products, std::chrono::milliseconds timeout)
        : client_(connect(daemon, timeout)) {
        disparity::Subscription subscription;
        subscription.products = products;
        client_.subscribe(subscription);
    }

    ReadResult read(Frame& frame, std::chrono::milliseconds timeout) override { return client_.read(frame, timeout); }
    std::string where() const override { return "socket"; }
    bool unanswered() const override { return client_.unanswered(); }

private:
    disparity::SocketClient client_;
};

}  // namespace

std::unique_ptr<FrameReader> open_frames(const DaemonAddress& daemon, const std::vector<Product>& products,
                                         std::chrono::milliseconds timeout) {
    if (!daemon.socket.empty()) {
        return std::make_unique<SocketFrames>(daemon, products, timeout);
    }
    std::string why;
    try {
        return std::make_unique<SharedMemoryFrames>(daemon.name, products);
    } catch (const std::runtime_error& error) {
        why = error.what();
    }
    try {
        return std::make_unique<SocketFrames>(daemon, products, timeout);
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(std::string(error.what()) + " (" + why + ")");
    }
}

}  // namespace disparityd::tools
