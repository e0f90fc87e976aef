// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/scan/scan_feed.h"

#include <algorithm>
#include <stdexcept>
#include <thread>
#include <utility>

#include "proto/disparity.pb.h"

namespace disparityd::tools {
namespace {

constexpr std::chrono::milliseconds between_looks{300};
constexpr std::chrono::seconds rate_window{2};

[[noreturn]] void refuse_daemon_without_scans() {
    throw std::runtime_error(
        "the daemon makes no obstacle scans: set [scan] enabled = true in its configuration and reload it");
}

/// Returns false when a daemon that answers says that it makes none.
bool may_make_scans(const DaemonAddress& daemon) {
    try {
        v1::Welcome welcome;
        if (!welcome.ParseFromString(connect(daemon).welcome()) || welcome.products().empty()) {
            return true;  // its source is being prepared
        }
        return std::find(welcome.products().begin(), welcome.products().end(), v1::SCAN) != welcome.products().end();
    } catch (const std::runtime_error&) {
        return true;
    }
}

}  // namespace

ScanFeed::ScanFeed(const DaemonAddress& daemon) : daemon_(daemon), frames_(open()) {}

std::unique_ptr<FrameReader> ScanFeed::open() const {
    return open_frames(daemon_, {disparity::Product::scan});
}

void ScanFeed::lose(const std::string& why) {
    frames_.reset();
    arrivals_.clear();
    why_ = why;
    look_again_ = Clock::now() + between_looks;
}

/// Looks for the daemon where it is time to. It is opened anew, so that its owner is checked again.
bool ScanFeed::come_back(std::chrono::milliseconds timeout) {
    const auto now = Clock::now();
    if (now < look_again_) {
        std::this_thread::sleep_until(std::min(look_again_, now + timeout));
        return false;
    }
    try {
        frames_ = open();
        old_frame_ = true;
        return true;
    } catch (const std::runtime_error&) {
        look_again_ = Clock::now() + between_looks;  // why it was lost says more than this
        return false;
    }
}

disparity::ReadResult ScanFeed::read(std::chrono::milliseconds timeout) {
    // Shared memory still holds the last frame from before, which may be hours old; and what a killed daemon has left
    // behind can be opened, too.
    if (std::exchange(old_frame_, false) &&
        frames_->read(frame_, std::chrono::milliseconds(0)) == disparity::ReadResult::gone) {
        return disparity::ReadResult::gone;
    }
    return frames_->read(frame_, timeout);
}

ScanFeed::Got ScanFeed::next(std::chrono::milliseconds timeout) {
    if (!frames_ && !come_back(timeout)) {
        return Got::no_daemon;
    }
    disparity::ReadResult result{};
    try {
        result = read(timeout);
    } catch (const std::runtime_error& error) {
        if (!may_make_scans(daemon_)) {
            refuse_daemon_without_scans();
        }
        lose(error.what());
        return Got::no_daemon;
    }
    if (result == disparity::ReadResult::gone) {
        lose(frames_->unanswered() ? "the daemon does not answer; waiting for it"
                                   : "the daemon has stopped; waiting for it");
        return Got::no_daemon;
    }
    return result == disparity::ReadResult::frame ? take() : Got::nothing;
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
