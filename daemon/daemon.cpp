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

#include "capture/start_thread.h"
#include "daemon/log.h"

namespace disparityd {
namespace {

/// What a source's preparation throws through open_source() when the daemon is to stop.
struct Cancelled {};

SocketServerConfig server_config(const Config& config) {
    return {config.socket.tcp, resolved_unix_path(config), static_cast<std::size_t>(config.socket.max_clients),
            static_cast<std::size_t>(config.socket.client_queue)};
}

std::string what(const std::exception_ptr& failure) {
    try {
        std::rethrow_exception(failure);
    } catch (const std::exception& error) {
        return error.what();
    }
}

}  // namespace

Daemon::Daemon(DaemonOptions options, Config config)
    : options_(std::move(options)),
      signals_(control_, SIGTERM, SIGINT, SIGHUP),
      tick_timer_(control_),
      config_(std::move(config)),
      server_(server_config(config_), {[this] { return status(); },
                                       [this](std::string path, SessionHost::RecordAnswer answer) {
                                           recording_.start(path, std::move(answer));
                                       },
                                       [this](SessionHost::RecordAnswer answer) { recording_.stop(std::move(answer)); },
                                       [this](const v1::CameraRequest& request, SessionHost::CameraAnswer answer) {
                                           camera_.ask(request, std::move(answer));
                                       }}),
      camera_([this] { return engine(); }) {
    recording_.configure(config_.record.enabled, resolved_record_directory(config_));
}

Daemon::~Daemon() {
    stopping_.store(true);
    if (builder_.joinable()) {
        builder_.join();
    }
    shut_down();
}

bool Daemon::run() {
    std::signal(SIGPIPE, SIG_IGN);
    wait_for_signal();
    tick();
    build_engine(config_);
    control_.run();
    if (builder_.joinable()) {
        builder_.join();
    }
    shut_down();
    if (fatal_) {
        std::rethrow_exception(fatal_);
    }
    return ended_well_;
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
    if (building_) {
        reload_again_ = true;
        return;
    }
    log_info("loading the configuration again");
    manager_.reloading();
    try {
        build_engine(load_config(options_.config_path, options_.overrides));
    } catch (const std::invalid_argument& error) {
        refuse_reload(error.what());
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

void Daemon::build_engine(Config config) {
    building_ = true;
    log_info(fmt::format("preparing {}", config.source.uri));
    if (builder_.joinable()) {
        builder_.join();
    }
    const auto current = engine();
    Engine::Heritage heritage{set_controls_, current ? current->camera_port() : ""};
    const auto tell = [this, config](std::shared_ptr<Engine> engine, const std::exception_ptr& failure) {
        boost::asio::post(
            control_, [this, config, engine = std::move(engine), failure] { engine_built(config, engine, failure); });
    };
    try {
        builder_ = capture::start_thread([this, tell, config = std::move(config), heritage = std::move(heritage)] {
            std::shared_ptr<Engine> engine;
            std::exception_ptr failure;
            try {
                engine = std::make_shared<Engine>(config, heritage, [this](int, int) {
                    if (stopping_.load(std::memory_order_relaxed)) {
                        throw Cancelled();
                    }
                });
            } catch (const Cancelled&) {
                return;
            } catch (const std::exception&) {
                failure = std::current_exception();
            }
            tell(std::move(engine), failure);
        });
    } catch (const std::runtime_error&) {
        tell(nullptr, std::current_exception());
    }
}

void Daemon::engine_built(const Config& config, const std::shared_ptr<Engine>& engine,
                          const std::exception_ptr& failure) {
    building_ = false;
    const bool for_source = std::exchange(building_for_source_, false);
    const bool put_back = std::exchange(putting_back_, false);
    if (stopping_.load(std::memory_order_relaxed)) {
        return;
    }
    if (failure && !serving_) {
        fatal_ = failure;
        begin_stop();
    } else if (failure && put_back) {
        say_nothing_runs(what(failure));
    } else if (failure && for_source) {
        log_error(fmt::format("the source cannot be opened anew: {}", what(failure)));
    } else if (failure) {
        refuse_reload(what(failure));
    } else {
        try {
            if (put_back) {
                shared_memory_.reset();  // it is the refused configuration's
            }
            take_over(config, engine);
            if (put_back) {
                note_refusal();
            }
        } catch (const std::exception& error) {
            if (!serving_) {
                fatal_ = std::current_exception();
                begin_stop();
                return;
            }
            const auto old = this->engine();
            if (!old || !old->stopped()) {
                refuse_reload(error.what());
            } else if (put_back) {
                say_nothing_runs(error.what());
            } else {
                refuse_reload(fmt::format("{}; the one before is put back", error.what()));
                putting_back_ = true;
                build_engine(config_);
            }
        }
    }
    if (std::exchange(reload_again_, false)) {
        reload();
    }
}

/// The index of the next frame, 0 where no engine has run.
std::uint64_t Daemon::stop_engine() {
    std::uint64_t index = 0;
    if (const auto old = engine()) {
        recording_.set_source(std::nullopt, old->source_changed() ? "the camera or its calibration has changed"
                                                                  : "the configuration was loaded again");
        old->stop();
        index = old->next_index();
    }
    const std::lock_guard lock(mutex_);
    notices_.clear();
    return index;
}

/// Everything that is likely to be refused comes first, so that the old engine still runs when it is.
void Daemon::take_over(const Config& config, const std::shared_ptr<Engine>& engine) {
    const bool same_object = shared_memory_ && config.shared_memory.enabled &&
                             config.shared_memory.name == config_.shared_memory.name &&
                             config.shared_memory.slots == config_.shared_memory.slots;
    std::unique_ptr<SharedMemoryPublisher> new_object;
    const bool same_name = shared_memory_ && config.shared_memory.name == config_.shared_memory.name;
    if (config.shared_memory.enabled && !same_object && !same_name) {
        new_object = std::make_unique<SharedMemoryPublisher>(config.shared_memory.name, engine->layout(),
                                                             static_cast<std::uint32_t>(config.shared_memory.slots));
    }
    if (serving_) {
        server_.reconfigure(server_config(config));
    }
    const std::uint64_t index = stop_engine();
    if (!same_object) {
        shared_memory_ = std::move(new_object);
    }
    serve_shared_memory(config, engine->layout());
    StreamLayout layout = engine->layout();
    layout.shared_memory = shared_memory_ ? shared_memory_->object_name() : "";
    server_.set_layout(layout);
    set_log_level(config.log.level);
    recording_.configure(config.record.enabled, resolved_record_directory(config));
    recording_.set_source(engine->source(), "");
    engine->start([this](const PublishedFrame& frame) { publish(frame); },
                  [this, live = engine->source().live](const capture::RawFrame& frame) {
                      recording_.offer(frame);
                      publish_sensors(frame, live);
                  },
                  index);
    config_ = config;
    end_seen_ = false;
    std::shared_ptr<Engine> old = engine;
    {
        const std::lock_guard lock(mutex_);
        engine_.swap(old);
    }
    old.reset();  // not under the lock: it frees gigabytes and waits for its threads
    if (!serving_) {
        start_serving();
    }
    log_info(fmt::format("serving {}: {} x {}, {}", engine->source().name, layout.geometry.width,
                         layout.geometry.height, engine->workers()));
    manager_.ready(status_line());
}

/// The object as configured; a failure here, with the old engine gone, leaves shared memory off and says so.
void Daemon::serve_shared_memory(const Config& config, const StreamLayout& layout) {
    if (!config.shared_memory.enabled) {
        return;
    }
    try {
        if (shared_memory_) {
            shared_memory_->relayout(layout);
        } else {
            shared_memory_ = std::make_unique<SharedMemoryPublisher>(
                config.shared_memory.name, layout, static_cast<std::uint32_t>(config.shared_memory.slots));
        }
    } catch (const std::exception& error) {
        if (!serving_) {
            throw;
        }
        shared_memory_.reset();
        log_error(fmt::format("shared memory is off: {}", error.what()));
        const std::lock_guard lock(mutex_);
        notices_.push_back(std::string("shared memory is off: ") + error.what());
    }
}

void Daemon::start_serving() {
    server_.start();
    serving_ = true;
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
    if (!stopping_.exchange(true)) {
        manager_.stopping();
        control_.stop();
    }
}

void Daemon::shut_down() {
    if (const auto last = engine()) {
        last->stop();
    }
    recording_.set_source(std::nullopt, "");
    recording_.wait();
    server_.stop();
    shared_memory_.reset();
}

std::shared_ptr<Engine> Daemon::engine() const {
    const std::lock_guard lock(mutex_);
    return engine_;
}

/// A recording's times are those of another day.
void Daemon::publish_sensors(const capture::RawFrame& frame, bool live) {
    if (!frame.sensors.empty()) {
        const std::chrono::nanoseconds measured(frame.sensors.back().monotonic_ns);
        server_.publish_sensors(
            frame.sensors, live ? std::chrono::steady_clock::time_point(measured) : std::chrono::steady_clock::now());
    }
}

void Daemon::publish(const PublishedFrame& frame) {
    if (shared_memory_) {
        shared_memory_->publish(frame);
    }
    server_.publish(frame);
}

}  // namespace disparityd
