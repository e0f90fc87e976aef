// SPDX-License-Identifier: Apache-2.0
//
// Watches over the running daemon: its source, memory and threads; and its status.
#include <algorithm>

#include <fmt/format.h>

#include "base/freed_memory.h"
#include "daemon/daemon.h"
#include "daemon/log.h"
#include "daemon/totals.h"
#include "proto/text.h"

namespace disparityd::daemon {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds tick_interval{200};
constexpr std::chrono::seconds status_interval{3};

/// The time between two attempts to open a changed source.
constexpr std::chrono::seconds reopen_interval{2};

/// A thread is stuck when it has not answered for so long, unless the watchdog has a limit of its own.
constexpr std::chrono::seconds default_stuck_limit{10};

/// The time between two times at which memory of clients that have gone is given back.
constexpr std::chrono::seconds give_back_interval{10};

/// The time between two looks for cores that other programs have given back.
constexpr std::chrono::seconds claim_interval{10};

/// How much more time the service manager is asked for while a source prepares itself.
constexpr std::chrono::seconds preparation_time{30};

}  // namespace

void Daemon::tick() {
    wait_for_tick();
    recording_.check();
    watch_source();
    watch_memory();
    watch_load();
    watch_cores();
    watch_trust();
    watch_freed_memory();
    watch_matcher();
    watch_threads();
    watch_places();
    const auto now = steady_clock::now();
    if (now >= next_status_) {
        next_status_ = now + status_interval;
        if (builder_.busy() && !serving()) {
            manager_.needs_time(preparation_time);
        }
        manager_.status(status_line());
    }
}

void Daemon::wait_for_tick() {
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
    const std::string announcement = std::string(to_string(condition.state)) + condition.detail;
    if (announcement != announced_) {
        announced_ = announcement;
        next_status_ = {};
    }
    const auto now = steady_clock::now();
    if (current->source_changed() && !builder_.busy() && now >= next_reopen_) {
        next_reopen_ = now + reopen_interval;
        builder_.build(BuildReason::source_changed, config_);
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

void Daemon::watch_load() {
    const auto current = engine();
    if (!current) {
        return;
    }
    for (const std::string& line : {current->check_load(), current->check_near()}) {
        if (!line.empty()) {
            log_warning(line);
        }
    }
}

void Daemon::watch_cores() {
    const auto now = steady_clock::now();
    const auto current = engine();
    if (!current || now < next_claim_) {
        return;
    }
    next_claim_ = now + claim_interval;
    if (current->check_cores()) {
        log_info(current->workers());
    }
}

void Daemon::watch_trust() {
    const auto current = engine();
    for (const std::string& line : current ? current->check_trust() : std::vector<std::string>()) {
        log_warning(line);
    }
}

/// Gives memory back after clients have gone: their messages were allocated.
void Daemon::watch_freed_memory() {
    const auto now = steady_clock::now();
    if (now >= next_give_back_ && server_.gone() != clients_gone_) {
        clients_gone_ = server_.gone();
        next_give_back_ = now + give_back_interval;
        base::give_back_freed_memory();
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

/// Feeds the watchdog while every thread answers.
void Daemon::watch_threads() {
    const auto watchdog = manager_.watchdog_limit();
    const auto limit = watchdog.count() > 0 ? std::chrono::duration_cast<std::chrono::milliseconds>(watchdog)
                                            : std::chrono::milliseconds(default_stuck_limit);
    const auto current = engine();
    std::string stuck = current ? current->stuck_stage(limit) : std::string();
    const auto silence = server_.silence();  // each call asks again
    if (stuck.empty() && serving() && silence > limit) {
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

void Daemon::watch_places() {
    if (shared_memory_) {
        memory_place_.check("shared memory " + shared_memory_->object_name(), shared_memory_->has_name(),
                            [this] { shared_memory_->restore(); });
    }
    if (serving()) {
        const std::string lost = server_.lost_address();
        socket_place_.check("socket " + lost, lost.empty(), [this] { server_.restore(); });
    }
}

std::string Daemon::status_line() const {
    const v1::Status now = status();
    std::string line = now.state();
    if (now.state() == "running") {
        line += fmt::format(", {:.1f} frames/s", now.rate());
    }
    line += ", " + now.source() + (now.synthetic() ? " (synthetic)" : "");
    return now.detail().empty() ? line : line + ": " + now.detail();
}

v1::Status Daemon::status() const {
    v1::Status status;
    status.set_server_version(DISPARITYD_VERSION);
    status.set_uptime_s(std::chrono::duration<double>(steady_clock::now() - started_).count());
    std::shared_ptr<Engine> current;
    v1::Totals ended;
    {
        const std::lock_guard lock(mutex_);  // one after the other, an engine that ends could count twice
        current = engine_;
        ended = ended_;
    }
    if (current) {
        current->fill(status);
    } else {
        status.set_state("waiting");
        status.set_detail("the daemon is preparing its source");
        status.set_source(proto::to_valid_utf8(first_source_));
    }
    add_totals(*status.mutable_totals(), ended);
    if (stopping()) {
        status.set_state("stopping");
    }
    *status.mutable_record() = recording_.status();
    for (const PlaceWatch* place : {&memory_place_, &socket_place_}) {
        if (const std::string notice = place->notice(); !notice.empty()) {
            status.add_notices(proto::to_valid_utf8(notice));
        }
    }
    const std::lock_guard lock(mutex_);
    for (const std::string& notice : notices_) {
        status.add_notices(proto::to_valid_utf8(notice));
    }
    return status;
}

}  // namespace disparityd::daemon
