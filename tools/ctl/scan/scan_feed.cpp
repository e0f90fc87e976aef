// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/scan/scan_feed.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "proto/disparity.pb.h"

namespace disparityd::tools {
namespace {

constexpr std::chrono::seconds rate_window{2};

[[noreturn]] void refuse_daemon_without_scans() {
    throw std::runtime_error(
        "the daemon makes no obstacle scans: set [scan] enabled = true in its configuration and reload it");
}

}  // namespace

ScanFeed::ScanFeed(const DaemonArguments& daemon) : client_(connect(daemon, {disparity::Product::scan})) {}

/// Returns false when a daemon that answers says that it makes none.
bool ScanFeed::may_make_scans() {
    try {
        v1::Welcome welcome;
        if (!welcome.ParseFromString(client_.socket().welcome()) || welcome.products().empty()) {
            return true;  // its source is being prepared
        }
        return std::find(welcome.products().begin(), welcome.products().end(), v1::SCAN) != welcome.products().end();
    } catch (const std::runtime_error&) {
        return true;
    }
}

/// Keeps why it was lost first: that says more than why it is not found again.
ScanFeed::Got ScanFeed::lose(const std::string& why) {
    if (std::exchange(there_, false) || why_.empty()) {
        why_ = why;
    }
    arrivals_.clear();
    return Got::no_daemon;
}

ScanFeed::Got ScanFeed::next(std::chrono::milliseconds timeout) {
    disparity::ReadResult result{};
    try {
        result = client_.read(frame_, timeout);
    } catch (const std::runtime_error& error) {
        if (!may_make_scans()) {
            refuse_daemon_without_scans();
        }
        return lose(error.what());
    }
    if (result == disparity::ReadResult::gone) {
        return lose(client_.unanswered() ? "the daemon does not answer; waiting for it"
                                         : "the daemon has stopped; waiting for it");
    }
    const bool came = !std::exchange(there_, true);
    if (result == disparity::ReadResult::timeout) {
        return Got::nothing;
    }
    // Shared memory still holds the last frame from before, which may be hours old.
    return came && client_.where().starts_with("shared memory") ? Got::nothing : take();
}

ScanFeed::Got ScanFeed::take() {
    auto scan = frame_.scan();
    if (!scan) {
        refuse_daemon_without_scans();
    }
    const auto now = Clock::now();
    arrivals_.push_back(now);
    while (now - arrivals_.front() > rate_window) {
        arrivals_.pop_front();
    }
    reading_.frame = frame_;
    reading_.scan = *std::move(scan);
    reading_.age_ns = frame_.age_ns;
    reading_.rate.reset();
    // The first ones may have waited, and come at once.
    if (const std::chrono::duration<double> span = now - arrivals_.front(); span > rate_window / 2) {
        reading_.rate = static_cast<double>(arrivals_.size() - 1) / span.count();
    }
    return Got::scan;
}

}  // namespace disparityd::tools
