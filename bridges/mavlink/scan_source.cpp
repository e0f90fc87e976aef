// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/scan_source.h"

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <thread>
#include <utility>

namespace disparityd::mavlink {
namespace {

using disparity::Product;
using disparity::ReadResult;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds pause_after_error{1000};
constexpr const char* refused_hint = "; where it serves no scan, set [scan] enabled = true in its configuration";

class SharedMemorySource : public ScanSource {
public:
    /// Throws std::invalid_argument; what a later daemon may do better waits for read().
    explicit SharedMemorySource(std::string name) : name_(std::move(name)) {
        try {
            connect();
        } catch (const std::runtime_error&) {
            // read() makes it again, and its caller says what is wrong.
        }
    }

private:
    void connect() { reader_.emplace(name_, disparity::SharedMemoryOptions{.may_be_absent = true}); }
    void disconnect() override { reader_.reset(); }
    std::string why_gone() const override { return reader_->why_gone(); }

    ReadResult read(disparity::Frame& frame, milliseconds timeout) override {
        if (!reader_) {
            connect();
        }
        return reader_->read(frame, timeout, {Product::scan});
    }

    std::string name_;
    std::optional<disparity::SharedMemoryReader> reader_;
};

class SocketSource : public ScanSource {
public:
    /// Throws std::invalid_argument; a daemon that is away waits for read().
    SocketSource(std::string address, disparity::ConnectOptions options, double max_rate)
        : address_(std::move(address)), options_(std::move(options)), max_rate_(max_rate) {
        try {
            connect();
        } catch (const std::runtime_error&) {
            // read() connects again, and its caller says what is wrong.
        }
    }

private:
    void connect() {
        disparity::SocketClient client(address_, options_, "disparity-mavlink", milliseconds(1000));
        client.subscribe({.products = {Product::scan}, .max_rate = max_rate_});
        client_.emplace(std::move(client));
        served_ = false;
    }
    void disconnect() override { client_.reset(); }
    std::string why_gone() const override { return client_->why_gone(); }

    ReadResult read(disparity::Frame& frame, milliseconds timeout) override {
        if (!client_) {
            connect();
        }
        try {
            const ReadResult result = client_->read(frame, timeout);
            served_ = served_ || result == ReadResult::frame;
            return result;
        } catch (const std::runtime_error& error) {
            // A daemon refuses a subscription to what it does not serve when it reads it, that is, here.
            throw std::runtime_error(error.what() + std::string(served_ ? "" : refused_hint));
        }
    }

    std::string address_;
    disparity::ConnectOptions options_;
    double max_rate_;
    std::optional<disparity::SocketClient> client_;
    bool served_ = false;  ///< a frame has come over this connection
};

}  // namespace

std::optional<TimedScan> ScanSource::next(milliseconds timeout) {
    const auto began = steady_clock::now();
    if (began < next_try_) {
        std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(timeout, next_try_ - began));
        return std::nullopt;
    }
    try {
        const ReadResult result = read(frame_, timeout);
        if (result == ReadResult::frame) {
            return scan_of(steady_clock::now() - std::chrono::nanoseconds(std::max<std::int64_t>(frame_.age_ns, 0)));
        }
        problem_ = result == ReadResult::gone ? why_gone() : std::string();
    } catch (const std::exception& error) {
        fail(error.what());
    }
    return std::nullopt;
}

std::optional<TimedScan> ScanSource::scan_of(steady_clock::time_point captured) {
    std::optional<disparity::Scan> scan = frame_.scan();
    if (!scan) {
        problem_ = "the daemon's frames carry no obstacle scan; set [scan] enabled = true in its configuration";
        return std::nullopt;
    }
    problem_.clear();
    return TimedScan{std::move(*scan), captured, (frame_.flags & disparity::synthetic) != 0};
}

void ScanSource::fail(const std::string& reason) {
    problem_ = reason;
    disconnect();
    next_try_ = steady_clock::now() + pause_after_error;
}

std::unique_ptr<ScanSource> shared_memory_source(const std::string& name) {
    return std::make_unique<SharedMemorySource>(name);
}

std::unique_ptr<ScanSource> socket_source(const std::string& address, const disparity::ConnectOptions& options,
                                          double max_rate) {
    return std::make_unique<SocketSource>(address, options, max_rate);
}

}  // namespace disparityd::mavlink
