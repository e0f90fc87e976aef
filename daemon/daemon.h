// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include "capture/set_controls.h"
#include "daemon/camera_control.h"
#include "daemon/config.h"
#include "daemon/engine.h"
#include "daemon/recording_control.h"
#include "daemon/service_manager.h"
#include "daemon/shared_memory_publisher.h"
#include "daemon/socket_server.h"

namespace disparityd {

struct DaemonOptions {
    std::string config_path;  ///< empty = built-in defaults
    std::vector<Override> overrides;
    bool exit_at_end = false;
    bool print_address = false;
};

/// The running daemon: one engine, its publishers, and the thread that hears signals and timers. Engines are built in a
/// thread of their own, so that a slow source never delays a stop or the watchdog.
class Daemon {
public:
    /// Binds the sockets. Throws std::runtime_error when an address is in use.
    Daemon(DaemonOptions options, Config config);
    ~Daemon();
    Daemon(const Daemon&) = delete;
    Daemon& operator=(const Daemon&) = delete;

    /// Serves until SIGTERM, SIGINT or, when asked for, the end of the source. Throws what the first engine or the
    /// shared memory throws; false when exit_at_end and the source ended by an error.
    bool run();

private:
    void wait_for_signal();
    void reload();
    void build_engine(Config config);
    void engine_built(const Config& config, const std::shared_ptr<Engine>& engine, const std::exception_ptr& failure);
    std::uint64_t stop_engine();
    void take_over(const Config& config, const std::shared_ptr<Engine>& engine);
    void refuse_reload(const std::string& why);
    void note_refusal();
    void say_nothing_runs(const std::string& why);
    void serve_shared_memory(const Config& config, const StreamLayout& layout);
    void start_serving();
    void begin_stop();
    void shut_down();

    void tick();
    void watch_source();
    void watch_memory();
    void watch_matcher();
    void watch_threads();
    std::string status_line() const;
    v1::Status status() const;
    std::shared_ptr<Engine> engine() const;
    void publish(const PublishedFrame& frame);
    void publish_sensors(const capture::RawFrame& frame, bool live);

    const DaemonOptions options_;
    const std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
    boost::asio::io_context control_{1};
    boost::asio::signal_set signals_;
    boost::asio::steady_timer tick_timer_;
    ServiceManager manager_;
    std::chrono::steady_clock::time_point next_status_;
    std::chrono::steady_clock::time_point next_alive_;
    std::chrono::steady_clock::time_point next_reopen_;
    std::string announced_;  ///< state and detail that the service manager knows

    // The control thread's.
    Config config_;
    std::thread builder_;
    const std::shared_ptr<capture::SetControls> set_controls_ = std::make_shared<capture::SetControls>();
    bool building_ = false;
    bool building_for_source_ = false;  ///< the configuration stays, the source has changed
    std::string refusal_;               ///< why the last reload was refused
    bool putting_back_ = false;         ///< the configuration before, after a new one that did not work
    bool reload_again_ = false;
    bool serving_ = false;
    bool end_seen_ = false;
    bool stuck_logged_ = false;
    std::string trouble_logged_;  ///< of the matcher
    bool ended_well_ = true;
    std::exception_ptr fatal_;

    // Between threads.
    std::atomic<bool> stopping_{false};
    mutable std::mutex mutex_;  ///< the two below
    std::shared_ptr<Engine> engine_;
    std::vector<std::string> notices_;

    std::unique_ptr<SharedMemoryPublisher> shared_memory_;  ///< the publish thread's while an engine runs
    SocketServer server_;                                   ///< outlives recording_, which answers through it
    RecordingControl recording_;
    CameraControlService camera_;  ///< answers through the server too
};

}  // namespace disparityd
