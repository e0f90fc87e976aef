// SPDX-License-Identifier: Apache-2.0
//
// What the daemon looks after while it runs: its source, its threads, and what it says about them.
#include <algorithm>

#include <fmt/format.h>

#include "daemon/daemon.h"
#include "daemon/log.h"
#include "proto/text.h"

namespace disparityd {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds tick_interval{200};
constexpr std::chrono::seconds status_interval{3};

/// Between two attempts to open a source anew that has changed.
constexpr std::chrono::seconds reopen_interval{2};

/// A thread that has not answered for so long is stuck, where no watchdog says otherwise.
constexpr std::chrono::seconds default_stuck_limit{10};

/// How much longer the service manager is asked to wait while a source prepares itself.
constexpr std::chrono::seconds preparation_time{30};

}  // namespace

void Daemon::tick() {
    recording_.check();
    watch_source();
    watch_memory();
    watch_matcher();
    watch_threads();
    const auto now = steady_clock::now();
    if (now >= next_status_) {
        next_status_ = now + status_interval;
        if (building_ && !serving_) {
            manager_.needs_time(preparation_time);
        }
        manager_.status(status_line());
    }
    // A watchdog may be shorter than the usual tick.
    auto interval = std::chrono::duration_cast<std::chrono::microseconds>(tick_interval);
    if (manager_.watchdog_limit().count() > 0) {
        interval = std::min(interval, manager_.watchdog_limit() / 4);
    }
    tick_timer_.expires_after(interval);
    tick_timer_.async_wait([this](const boost::system::error_code& error) {
        if (!error) {
            tick();
        }
    });
}

void Daemon::watch_source() {
    const auto current = engine();
    if (!current || end_seen_) {
        return;
    }
    const Engine::Condition condition = current->condition();
    const std::string announcement = std::string(name(condition.state)) + condition.detail;
    if (announcement != announced_) {
        announced_ = announcement;
        next_status_ = {};
    }
    const auto now = steady_clock::now();
    if (current->source_changed() && !building_ && now >= next_reopen_) {
        next_reopen_ = now + reopen_interval;
        building_for_source_ = true;
        build_engine(config_);
    }
    if (condition.state != Engine::State::ended) {
        return;
    }
    end_seen_ = true;
    log_line(condition.failed ? LogLevel::error : LogLevel::info, condition.detail);
    recording_.set_source(std::nullopt, "");
    if (options_.exit_at_end) {
        ended_well_ = !condition.failed;
        begin_stop();
    }
}

void Daemon::watch_memory() {
    const auto current = engine();
    if (current && current->check_memory()) {
        log_info(current->notices().back());
    }
}

void Daemon::watch_matcher() {
    const auto current = engine();
    const std::string trouble = current ? current->matcher_trouble() : std::string();
    if (trouble != trouble_logged_ && !trouble.empty()) {
        log_warning(trouble);
    }
    trouble_logged_ = trouble;
}

/// The watchdog is fed only while every thread answers.
void Daemon::watch_threads() {
    const auto watchdog = manager_.watchdog_limit();
    const auto limit = watchdog.count() > 0 ? std::chrono::duration_cast<std::chrono::milliseconds>(watchdog)
                                            : std::chrono::milliseconds(default_stuck_limit);
    const auto current = engine();
    std::string stuck = current ? current->stuck_stage(limit) : std::string();
    if (stuck.empty() && serving_ && server_.silence() > limit) {
        stuck = "socket server";
    }
    if (!stuck.empty()) {
        if (!stuck_logged_) {
            log_error(fmt::format("stage \"{}\" has not answered for {} ms{}", stuck, limit.count(),
                                  watchdog.count() > 0 ? ": the watchdog is no longer fed" : ""));
        }
        stuck_logged_ = true;
        return;
    }
    stuck_logged_ = false;
    const auto now = steady_clock::now();
    if (watchdog.count() > 0 && now >= next_alive_) {
        next_alive_ = now + watchdog / 2;
        manager_.alive();
    }
}

std::string Daemon::status_line() const {
    const v1::Status now = status();
    std::string line = now.state();
    if (now.state() == "running") {
        line += fmt::format(", {:.1f} frames/s", now.rate());
    }
    line += ", " + now.source();
    return now.detail().empty() ? line : line + ": " + now.detail();
}

v1::Status Daemon::status() const {
    v1::Status status;
    status.set_server_version(DISPARITYD_VERSION);
    status.set_uptime_s(std::chrono::duration<double>(steady_clock::now() - started_).count());
    if (const auto current = engine()) {
        current->fill(status);
    } else {
        status.set_state("waiting");
        status.set_detail("the source is being prepared");
        status.set_source(proto::text(options_.config_path));
    }
    if (stopping_.load(std::memory_order_relaxed)) {
        status.set_state("stopping");
    }
    *status.mutable_record() = recording_.status();
    const std::lock_guard lock(mutex_);
    for (const std::string& notice : notices_) {
        status.add_notices(proto::text(notice));
    }
    return status;
}

}  // namespace disparityd
