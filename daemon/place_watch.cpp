// SPDX-License-Identifier: Apache-2.0
#include "daemon/place_watch.h"

#include <exception>
#include <utility>

#include <fmt/format.h>

#include "base/failure_text.h"

namespace disparityd::daemon {
namespace {

/// The time between two failed attempts to make a place anew.
constexpr std::chrono::seconds patience{1};

}  // namespace

void PlaceWatch::check(const std::string& place, bool ours, const std::function<void()>& make_anew) {
    if (ours) {
        if (std::exchange(lost_, false)) {
            say(fmt::format("{} is there again", place_));
        }
        return;
    }
    const auto now = std::chrono::steady_clock::now();
    if (now < next_attempt_) {
        return;
    }
    lost_ = true;
    place_ = place;
    try {
        make_anew();
    } catch (const std::exception& error) {
        next_attempt_ = now + patience;
        say(fmt::format("{} was removed or replaced by another program and cannot be made anew: {}; trying again",
                        place, base::failure_text(error)));
        return;
    }
    lost_ = false;
    ++times_;
    next_attempt_ = {};
    say(fmt::format("{} was removed or replaced by another program; made anew{}", place,
                    times_ > 1 ? fmt::format(", {} times now", times_) : ""));
}

void PlaceWatch::say(const std::string& line) {
    // Only this thread writes the notice, so it reads it without the lock.
    if (line == notice_) {
        return;
    }
    {
        const std::lock_guard lock(mutex_);
        notice_ = line;
    }
    log_.write(LogLevel::warning, line);
}

void PlaceWatch::forget() {
    const std::lock_guard lock(mutex_);
    notice_.clear();
    times_ = 0;
}

std::string PlaceWatch::notice() const {
    const std::lock_guard lock(mutex_);
    return notice_;
}

}  // namespace disparityd::daemon
