// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/scan_source.h"

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <thread>
#include <utility>

#include "bridges/program/waiting_client.h"

namespace disparityd::mavlink {
namespace {

using disparity::Product;
using disparity::ReadResult;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds pause_after_error{1000};
constexpr const char* refused_hint = "; where it serves no scan, set [scan] enabled = true in its configuration";

}  // namespace

ScanSource::ScanSource(const std::string& where, disparity::ClientOptions options, double max_rate) {
    disparity::Subscription wanted;
    wanted.products = {Product::scan};
    wanted.max_rate = max_rate;
    client_.emplace(where, wanted, bridges::waiting_for_the_daemon(std::move(options)));
}

ReadResult ScanSource::read(disparity::Frame& frame, milliseconds timeout) {
    try {
        const ReadResult result = client_->read(frame, timeout);
        served_ = (served_ && result != ReadResult::gone) || result == ReadResult::frame;
        return result;
    } catch (const std::runtime_error& error) {
        // A daemon refuses a subscription to what it does not serve when it reads it, that is, here.
        throw std::runtime_error(error.what() + std::string(std::exchange(served_, false) ? "" : refused_hint));
    }
}

std::string ScanSource::why_gone() const {
    return client_->why_gone();
}

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
    return TimedScan{std::move(*scan), captured, (frame_.flags & disparity::synthetic) != 0, frame_.flags};
}

void ScanSource::fail(const std::string& reason) {
    problem_ = reason;
    next_try_ = steady_clock::now() + pause_after_error;
}

}  // namespace disparityd::mavlink
