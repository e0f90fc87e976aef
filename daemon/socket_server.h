// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>

#include "daemon/client_session.h"
#include "daemon/frame_compressor.h"
#include "daemon/frame_pool.h"
#include "daemon/frame_ring.h"
#include "daemon/listener.h"
#include "daemon/one_thread.h"
#include "daemon/sensor_ring.h"

namespace disparityd {

/// Where and how to serve; the addresses are resolved.
struct SocketServerConfig {
    std::string tcp;        ///< empty = off
    std::string unix_path;  ///< empty = off
    std::size_t max_clients = 64;
    std::size_t client_queue = 4;
};

/// What the server asks of the daemon; called in the server's thread, must not block.
struct SocketServices {
    std::function<v1::Status()> status;  ///< without the clients, which the server adds
    /// May answer from any thread, later.
    std::function<void(std::string path, SessionHost::RecordAnswer answer)> start_recording;
    std::function<void(SessionHost::RecordAnswer answer)> stop_recording;
    std::function<void(const v1::CameraRequest& request, SessionHost::CameraAnswer answer)> control_camera;
};

/// Serves frames and status over TCP and a Unix socket, in one thread of its own. Whoever publishes never waits for it:
/// a frame is copied into a bounded pool (only the planes that somebody wants), everything else happens here.
class SocketServer final : private SessionHost {
public:
    /// Binds; throws as make_tcp_listener() and make_unix_listener(). Nobody can connect before start().
    SocketServer(const SocketServerConfig& config, SocketServices services);
    ~SocketServer() override;
    SocketServer(const SocketServer&) = delete;
    SocketServer& operator=(const SocketServer&) = delete;

    /// Begins to serve. Throws when an address has been taken since it was bound.
    void start();

    /// Closes all connections and joins the thread. Safe to call twice.
    void stop();

    /// Other addresses and limits; clients stay connected. Throws as the constructor; nothing has changed then. By the
    /// thread that calls start() and stop(). A longer client_queue counts from the next set_layout() on.
    void reconfigure(const SocketServerConfig& config);

    /// What the frames from now on look like. Same thread as reconfigure(), while nobody publishes; also before
    /// start().
    void set_layout(const StreamLayout& layout);

    /// Hands over a frame of that layout. One thread at a time; allocates nothing while no client wants frames.
    void publish(const PublishedFrame& frame);

    /// Hands over samples of the camera's sensors, the last one measured at `newest`. One thread at a time; never
    /// waits, allocates nothing while no client wants them. What the server is too busy for is lost and counted in the
    /// sample that follows.
    void publish_sensors(std::span<const capture::SensorSample> samples, SensorRing::Time newest);

    /// The addresses that are served, ports as bound. Same thread as reconfigure().
    std::vector<std::string> addresses() const;

    /// How long the server's thread has not answered; it is asked again by every call. One thread.
    std::chrono::nanoseconds silence();

    /// Frames that were copied for nobody because all copies were in use. Any thread.
    std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

private:
    using Listeners = std::vector<std::shared_ptr<Listener>>;

    const StreamLayout& layout() const override { return layout_; }
    FrameRing& frames() override { return ring_; }
    FrameCompressor& compressor() override { return compressor_; }
    const SensorRing& sensors() override { return sensors_; }
    ClientLog& log() override { return log_; }
    v1::Status status() override;
    void start_recording(const std::string& path, RecordAnswer answer) override;
    void stop_recording(RecordAnswer answer) override;
    void control_camera(const v1::CameraRequest& request, CameraAnswer answer) override;
    void subscription_changed() override;
    void closed(std::uint64_t id) override;

    Listeners make_listeners(const SocketServerConfig& config, const Listeners& kept);
    void accepted(ClientSession::Socket socket, std::string address);
    void frame_arrived(FrameHandle frame);
    void sensors_arrived(const std::vector<capture::SensorSample>& samples, SensorRing::Time newest);
    std::vector<std::shared_ptr<ClientSession>> sessions() const;
    RecordAnswer in_server_thread(RecordAnswer answer);

    boost::asio::io_context io_{1};
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_;
    SocketServices services_;
    std::thread thread_;

    // The configuring thread's.
    SocketServerConfig config_;
    Listeners listeners_;
    std::chrono::steady_clock::time_point asked_;

    // The publisher's, changed by the configuring thread while nobody publishes.
    std::unique_ptr<FramePool> pool_;

    // Of the thread that publishes sensors.
    std::uint32_t samples_lost_ = 0;

    // Between threads.
    std::atomic<std::uint32_t> wanted_{0};
    std::atomic<bool> sensors_wanted_{false};
    std::atomic<std::size_t> samples_on_the_way_{0};
    std::atomic<std::uint64_t> lost_{0};
    std::atomic<bool> answered_{true};

    // The server thread's.
    StreamLayout layout_;
    FrameRing ring_;
    boost::asio::thread_pool compressing_ = one_thread();
    FrameCompressor compressor_;
    SensorRing sensors_;
    ClientLog log_;
    std::size_t max_clients_;
    std::map<std::uint64_t, std::shared_ptr<ClientSession>> clients_;
    std::map<std::uint64_t, std::shared_ptr<ClientSession>> refused_;
    std::uint64_t next_id_ = 1;
};

}  // namespace disparityd
