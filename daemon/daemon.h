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
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include "capture/camera/camera_controls.h"
#include "daemon/build_reason.h"
#include "daemon/config/config.h"
#include "daemon/engine.h"
#include "daemon/engine_builder.h"
#include "daemon/place_watch.h"
#include "daemon/requests/camera_request.h"
#include "daemon/requests/recording_control.h"
#include "daemon/requests/trace_request.h"
#include "daemon/shared_memory_publisher.h"
#include "daemon/socket/socket_server.h"
#include "daemon/system/service_manager.h"

namespace disparityd::daemon {

struct DaemonOptions {
    std::string config_path;  ///< empty = built-in defaults
    std::vector<Override> overrides;
    bool exit_at_end = false;
    bool print_address = false;
};

/// The running daemon: one engine, its publishers, and the control thread, which handles signals and timers. Engines
/// are built in a thread of their own, so that a slow source never delays a stop or the watchdog.
class Daemon {
public:
    /// Binds the sockets. Throws std::runtime_error when an address is in use.
    Daemon(DaemonOptions options, Config config);
    ~Daemon();
    Daemon(const Daemon&) = delete;
    Daemon& operator=(const Daemon&) = delete;

    /// Serves until SIGTERM, SIGINT or, with exit_at_end, the end of the source. Throws what the first engine or the
    /// shared memory throws. Returns false with exit_at_end when the source ended by an error.
    bool run();

private:
    /// Each is reached once, in this order; `serving` may be left out.
    enum class Phase : unsigned char {
        starting,  ///< no engine has run yet
        serving,
        stopping,
    };

    bool serving() const { return phase_.load(std::memory_order_relaxed) == Phase::serving; }
    bool stopping() const { return phase_.load(std::memory_order_relaxed) == Phase::stopping; }

    void control();
    void wait_for_signal();
    void wait_for_tick();
    void look_for_built();
    void reload();
    std::shared_ptr<Engine> make_engine(const Config& config, const EngineBuilder::Progress& progress) const;
    void put_to_work(const EngineBuilder::Built& built);
    void handle_failure(FailureAction action, const std::exception_ptr& failure);
    std::uint64_t stop_engine();
    v1::Totals totals_of_ended() const;
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
    void watch_load();
    void watch_cores();
    void watch_trust();
    void watch_freed_memory();
    void watch_matcher();
    void watch_threads();
    void watch_places();
    std::string status_line() const;
    v1::Status status() const;
    std::shared_ptr<Engine> engine() const;
    void publish(const PublishedFrame& frame);
    bool is_outdated(const PublishedFrame& frame) const { return frame.taken < wanted_since_.load(); }
    bool wants_frames();
    void publish_sensors(const capture::RawFrame& frame, bool live);

    static constexpr auto always_wanted = std::chrono::steady_clock::time_point::min();  ///< so without on_demand
    static constexpr auto never_wanted = std::chrono::steady_clock::time_point::max();

    const DaemonOptions options_;
    const std::string first_source_;  ///< what the status names while there is no engine
    const std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
    boost::asio::io_context control_{1};
    boost::asio::signal_set signals_;
    boost::asio::steady_timer tick_timer_;
    ServiceManager manager_;
    std::chrono::steady_clock::time_point next_status_;
    std::chrono::steady_clock::time_point next_alive_;
    std::chrono::steady_clock::time_point next_reopen_;
    std::chrono::steady_clock::time_point next_claim_;
    std::string announced_;  ///< state and detail that the service manager was told

    // The control thread uses these alone.
    Config config_;
    const std::shared_ptr<capture::ControlOverrides> control_overrides_ = std::make_shared<capture::ControlOverrides>();
    std::string refusal_;        ///< why the last reload was refused
    bool reload_again_ = false;  ///< a reload was asked for while an engine was being built
    bool end_seen_ = false;
    bool stuck_logged_ = false;
    std::uint64_t clients_gone_ = 0;  ///< value of server_.gone() when freed memory was given back
    std::chrono::steady_clock::time_point next_give_back_;
    std::string trouble_logged_;  ///< of the matcher, as logged last
    bool ended_well_ = true;
    std::exception_ptr fatal_;

    // Several threads use these.
    std::atomic<Phase> phase_{Phase::starting};
    mutable std::mutex mutex_;  ///< the three below
    std::shared_ptr<Engine> engine_;
    v1::Totals ended_;  ///< of the engines before; only the control thread changes it, together with engine_
    std::vector<std::string> notices_;

    EngineBuilder builder_;  ///< its thread uses what stands above

    PlaceWatch memory_place_;
    PlaceWatch socket_place_;
    std::unique_ptr<SharedMemoryPublisher> shared_memory_;  ///< the publish thread's while an engine runs
    /// Frames that the pipeline took before are old to who comes: `never_wanted` while the newest frame is not wanted.
    std::atomic<std::chrono::steady_clock::time_point> wanted_since_{always_wanted};
    SocketServer server_;  ///< outlives recording_, which answers through it
    RecordingControl recording_;
    CameraControlService camera_;  ///< answers through the server too, as the next one
    TraceService trace_;
};

}  // namespace disparityd::daemon
