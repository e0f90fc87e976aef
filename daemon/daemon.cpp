// SPDX-License-Identifier: Apache-2.0
#include "daemon/daemon.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "base/descriptor_limit.h"
#include "base/failure_text.h"
#include "base/freed_memory.h"
#include "base/out_of_memory.h"
#include "capture/shown_source.h"
#include "daemon/configured_access.h"
#include "daemon/ends_alone.h"
#include "daemon/log.h"
#include "daemon/requests/level_request.h"
#include "daemon/requests/record_request.h"
#include "daemon/totals.h"

namespace disparityd::daemon {
namespace {

SocketServerConfig server_config(const Config& config) {
    SocketServerConfig server;
    server.tcp = config.socket.tcp;
    server.unix_path = resolved_unix_path(config);
    server.max_clients = static_cast<std::size_t>(config.socket.max_clients);
    server.client_queue = static_cast<std::size_t>(config.socket.client_queue);
    server.access = client_access(config);
    server.tls = client_tls(config);
    server.idle_timeout = std::chrono::seconds(config.socket.idle_timeout_s);
    server.descriptors = base::raise_descriptor_limit();
    return server;
}

RecordRules record_rules(const Config& config) {
    const RecordDirectory directory = resolved_record_directory(config);
    constexpr std::uint64_t mb = 1'000'000;
    return {config.record.enabled,
            directory.path,
            directory.chosen,
            static_cast<std::uint64_t>(config.record.keep_free_mb) * mb,
            static_cast<std::uint64_t>(config.record.max_mb) * mb,
            std::chrono::seconds(config.record.max_s),
            config.record.when_client_is_gone == WhenClientIsGone::stop};
}

/// Tells which addresses of the socket have come and gone.
void log_changes(const std::vector<std::string>& before, const std::vector<std::string>& now) {
    const auto has = [](const std::vector<std::string>& all, const std::string& address) {
        return std::find(all.begin(), all.end(), address) != all.end();
    };
    for (const std::string& address : before) {
        if (!has(now, address)) {
            log_info(fmt::format("no longer serving at {}", address));
        }
    }
    for (const std::string& address : now) {
        if (!has(before, address)) {
            log_info(fmt::format("serving at {}", address));
        }
    }
}

}  // namespace

Daemon::Daemon(DaemonOptions options, Config config)
    : options_(std::move(options)),
      first_source_(capture::shown_source(config.source.uri)),
      signals_(control_, SIGTERM, SIGINT, SIGHUP),
      tick_timer_(control_),
      config_(std::move(config)),
      builder_(
          [this](const Config& built, const EngineBuilder::Progress& progress) { return make_engine(built, progress); },
          [this] { boost::asio::post(control_, [this] { look_for_built(); }); }),
      server_(server_config(config_), [this] { return status(); },
              {record_start_request(recording_), record_stop_request(recording_), camera_request(camera_),
               trace_request(trace_), level_request([this] { return engine(); })}),
      camera_([this] { return engine(); }),
      trace_(control_, [this] { return engine(); }) {
    recording_.configure(record_rules(config_));
}

Daemon::~Daemon() {
    phase_.store(Phase::stopping);
    builder_.cancel();
    builder_.wait();
    shut_down();
}

bool Daemon::run() {
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);  // writing beyond a file limit then fails like a full disk
    wait_for_signal();
    tick();
    server_.start();  // clients get a status while the first source is prepared
    builder_.build(BuildReason::start, config_);
    control();
    builder_.wait();
    shut_down();
    if (fatal_) {
        std::rethrow_exception(fatal_);
    }
    return ended_well_;
}

/// Runs signals and ticks. After a handler that failed it waits for both again.
void Daemon::control() {
    while (!ends_alone("the daemon goes on", [this] { control_.run(); })) {
        signals_.cancel();
        wait_for_signal();
        wait_for_tick();
    }
}

void Daemon::wait_for_signal() {
    signals_.async_wait([this](const boost::system::error_code& error, int signal) {
        if (error) {
            return;
        }
        if (signal == SIGHUP) {
            reload();
        } else {
            log_info(fmt::format("stopping: {}", signal == SIGTERM ? "SIGTERM" : "SIGINT"));
            begin_stop();
        }
        wait_for_signal();
    });
}

void Daemon::reload() {
    if (builder_.busy()) {
        reload_again_ = true;
        return;
    }
    log_info("loading the configuration again");
    manager_.reloading();
    try {
        builder_.build(BuildReason::reload, load_config(options_.config_path, options_.overrides));
    } catch (const std::exception& error) {
        refuse_reload(base::failure_text(error));
    }
}

void Daemon::say_nothing_runs(const std::string& why) {
    const std::string line = fmt::format("the configuration before cannot be put back: {}; reload it", why);
    log_error(line);
    const std::lock_guard lock(mutex_);
    notices_.push_back(line);
}

void Daemon::refuse_reload(const std::string& why) {
    log_error(fmt::format("nothing is changed, the new configuration is refused: {}", why));
    refusal_ = why;
    note_refusal();
    manager_.ready(status_line());
}

void Daemon::note_refusal() {
    const std::lock_guard lock(mutex_);
    notices_ = {"the configuration was refused at the last reload: " + refusal_};
}

/// Makes an engine, in the builder's thread.
std::shared_ptr<Engine> Daemon::make_engine(const Config& config, const EngineBuilder::Progress& progress) const {
    Engine::CarryOver carry_over{control_overrides_, ""};
    if (const auto current = engine()) {
        carry_over.camera_port = current->camera_port();
    }
    return std::make_shared<Engine>(config, carry_over, progress);
}

void Daemon::look_for_built() {
    const auto built = builder_.take();
    if (!built || stopping()) {
        return;
    }
    if (built->failure) {
        handle_failure(after_failed_build(built->reason), built->failure);
    } else {
        put_to_work(*built);
    }
    if (!stopping() && std::exchange(reload_again_, false)) {
        reload();
    }
}

void Daemon::put_to_work(const EngineBuilder::Built& built) {
    const bool rollback = built.reason == BuildReason::rollback;
    try {
        const base::MemoryMayBeRefused refusable;
        if (rollback) {
            shared_memory_.reset();  // it is the refused configuration's
        }
        take_over(*built.config, built.engine);
        if (rollback) {
            note_refusal();
        }
    } catch (...) {
        const auto old = engine();
        const EngineInUse in_use = !old             ? EngineInUse::none
                                   : old->stopped() ? EngineInUse::stopped
                                                    : EngineInUse::running;
        handle_failure(after_failed_take_over(built.reason, in_use), std::current_exception());
    }
}

void Daemon::handle_failure(FailureAction action, const std::exception_ptr& failure) {
    const std::string why = base::failure_text(failure);
    switch (action) {
        case FailureAction::end_daemon:
            fatal_ = failure;
            begin_stop();
            break;
        case FailureAction::refuse_reload: refuse_reload(why); break;
        case FailureAction::keep_source: log_error(fmt::format("the source cannot be opened anew: {}", why)); break;
        case FailureAction::roll_back:
            refuse_reload(fmt::format("{}; the one before is put back", why));
            builder_.build(BuildReason::rollback, config_);
            break;
        case FailureAction::wait_for_reload: say_nothing_runs(why); break;
    }
}

/// Stops the engine in use. Returns the index of the next frame, 0 where no engine has run.
std::uint64_t Daemon::stop_engine() {
    std::uint64_t index = 0;
    if (const auto old = engine()) {
        recording_.set_source(std::nullopt, old->source_changed() ? "the camera or its calibration has changed"
                                                                  : "the configuration was loaded again");
        old->stop();
        index = old->next_index();
    }
    memory_place_.forget();
    socket_place_.forget();
    const std::lock_guard lock(mutex_);
    notices_.clear();
    return index;
}

/// Returns the counts of all engines up to the one in use, which has been stopped.
v1::Totals Daemon::totals_of_ended() const {
    v1::Status last;
    if (const auto stopped = engine()) {
        stopped->fill(last);
    }
    v1::Totals totals = last.totals();
    add_totals(totals, ended_);
    return totals;
}

/// Replaces the engine in use. Steps that the system may refuse come first, while the old engine still runs.
void Daemon::take_over(const Config& config, const std::shared_ptr<Engine>& engine) {
    // Another number of slots, too, is another layout under the same name: readers find no gap.
    const bool same_object =
        shared_memory_ && config.shared_memory.enabled && config.shared_memory.name == config_.shared_memory.name;
    std::unique_ptr<SharedMemoryPublisher> new_object;
    if (config.shared_memory.enabled && !same_object) {
        new_object = std::make_unique<SharedMemoryPublisher>(config.shared_memory.name, engine->layout(),
                                                             static_cast<std::uint32_t>(config.shared_memory.slots));
    }
    if (serving()) {
        const std::vector<std::string> before = server_.addresses();
        server_.reconfigure(server_config(config));
        log_changes(before, server_.addresses());
    }
    const std::uint64_t index = stop_engine();
    v1::Totals ended = totals_of_ended();
    if (!same_object) {
        shared_memory_ = std::move(new_object);
    }
    serve_shared_memory(config, engine->layout());
    StreamLayout layout = engine->layout();
    layout.shared_memory = shared_memory_ ? shared_memory_->object_name() : "";
    server_.set_layout(layout);
    set_log_level(config.log.level);
    recording_.configure(record_rules(config));
    recording_.set_source(engine->source(), "");
    wanted_since_.store(always_wanted);
    engine->start([this](const PublishedFrame& frame) { publish(frame); },
                  [this, live = engine->source().live](const capture::RawFrame& frame) {
                      recording_.offer(frame);
                      publish_sensors(frame, live);
                  },
                  [this] { return wants_frames(); }, index);
    config_ = config;
    end_seen_ = false;
    std::shared_ptr<Engine> old = engine;
    {
        const std::lock_guard lock(mutex_);
        engine_.swap(old);
        ended_.Swap(&ended);
    }
    old.reset();  // not under the lock: it frees gigabytes and waits for its threads
    base::give_back_freed_memory();
    if (!serving()) {
        start_serving();
    }
    log_info(fmt::format("serving {}: {} x {}, {}", engine->source().name, layout.geometry.width,
                         layout.geometry.height, engine->workers()));
    if (const std::string distances = engine->distances(); !distances.empty()) {
        log_info(distances);
    }
    const MemoryBounds memory = engine->memory();
    log_info(memory.text());
    if (const std::string warning = memory.warning(base::memory_room()); !warning.empty()) {
        log_warning(warning);
    }
    if (engine->source().synthetic) {
        log_warning(Engine::synthetic_notice);
    }
    manager_.ready(status_line());
}

/// Makes the shared memory as configured. When that fails after the start, shared memory stays off and a notice says
/// so.
void Daemon::serve_shared_memory(const Config& config, const StreamLayout& layout) {
    if (!config.shared_memory.enabled) {
        return;
    }
    try {
        if (shared_memory_) {
            shared_memory_->relayout(layout, static_cast<std::uint32_t>(config.shared_memory.slots));
        } else {
            shared_memory_ = std::make_unique<SharedMemoryPublisher>(
                config.shared_memory.name, layout, static_cast<std::uint32_t>(config.shared_memory.slots));
        }
    } catch (const std::exception& error) {
        if (!serving()) {
            throw;
        }
        shared_memory_.reset();
        const std::string line = "shared memory is off: " + base::failure_text(error);
        log_error(line);
        const std::lock_guard lock(mutex_);
        notices_.push_back(line);
    }
}

void Daemon::start_serving() {
    phase_.store(Phase::serving);
    std::vector<std::string> addresses = server_.addresses();
    if (shared_memory_) {
        addresses.push_back("shm:" + shared_memory_->object_name());
    }
    for (const std::string& address : addresses) {
        log_info(fmt::format("serving at {}", address));
        if (options_.print_address) {
            std::printf("%s\n", address.c_str());
        }
    }
    if (options_.print_address) {
        std::printf("ready\n");
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
            fatal_ = std::make_exception_ptr(std::runtime_error(
                fmt::format("standard output, which --print-address writes to: {}", std::strerror(errno))));
            begin_stop();
        }
    }
}

void Daemon::begin_stop() {
    if (phase_.exchange(Phase::stopping) != Phase::stopping) {
        builder_.cancel();
        manager_.stopping();
        control_.stop();
    }
}

void Daemon::shut_down() {
    if (const auto last = engine()) {
        last->stop();
    }
    ends_alone("the recording is finished at the end", [this] {  // by its destructor
        recording_.set_source(std::nullopt, "");
        recording_.wait();
    });
    server_.stop();
    shared_memory_.reset();
}

std::shared_ptr<Engine> Daemon::engine() const {
    const std::lock_guard lock(mutex_);
    return engine_;
}

/// Publishes samples. The times of a recording are from another day: they are not compared with the clock.
void Daemon::publish_sensors(const capture::RawFrame& frame, bool live) {
    if (!frame.sensors.empty()) {
        const std::chrono::nanoseconds measured(frame.sensors.back().monotonic_ns);
        server_.publish_sensors(
            frame.sensors, live ? std::chrono::steady_clock::time_point(measured) : std::chrono::steady_clock::now());
    }
}

void Daemon::publish(const PublishedFrame& frame) {
    if (shared_memory_) {
        // It was wanted when it was taken. Newer ones were not, and nobody who comes later may take it for one of then.
        shared_memory_->publish(frame, is_outdated(frame));
        if (is_outdated(frame)) {  // since then
            shared_memory_->outdate();
        }
    }
    server_.publish(frame);
}

/// Called by the capture thread: for each frame with [pipeline] on_demand, before the first one with [source] start.
bool Daemon::wants_frames() {
    const bool wanted =
        server_.wants_frames() || recording_.is_recording() || (shared_memory_ && shared_memory_->has_reader());
    if (!wanted) {
        wanted_since_.store(never_wanted);
    } else if (wanted_since_.load() == never_wanted) {
        wanted_since_.store(std::chrono::steady_clock::now());
    }
    if (!wanted && shared_memory_) {
        shared_memory_->outdate();  // who opens it later is to get a frame of then
    }
    return wanted;
}

}  // namespace disparityd::daemon
