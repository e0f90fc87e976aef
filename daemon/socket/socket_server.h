// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "daemon/one_thread.h"
#include "daemon/requests/request.h"
#include "daemon/socket/clients.h"
#include "daemon/socket/frames/frame_pool.h"
#include "daemon/socket/frames/sensor_ring.h"
#include "daemon/socket/listener.h"

namespace disparityd::daemon {

/// Where and how to serve; the addresses are resolved.
struct SocketServerConfig {
    std::string tcp;        ///< empty = off
    std::string unix_path;  ///< empty = off
    std::size_t max_clients = 64;
    std::size_t client_queue = 4;
    ClientAccess access;                             ///< unix_path and encrypted are set by the server
    proto::TlsContext tls;                           ///< for TCP; null: not encrypted
    std::chrono::milliseconds idle_timeout{60'000};  ///< for clients without subscription and request; 0 = unlimited
    std::size_t descriptors = SIZE_MAX;              ///< that the process may have open
    TcpLiveness liveness;
    std::chrono::microseconds request_interval = ClientRules().request_interval;
    std::chrono::milliseconds handshake_interval{10};  ///< between two TLS handshakes, after a few at once
};

/// Serves frames and status over TCP and a Unix socket, in one thread of its own. The publisher never waits for it: it
/// copies the planes that clients want into a bounded pool; the server's thread does the rest.
class SocketServer {
public:
    /// Copies of frames beyond client_queue: one that is being filled, some on the way to the server's thread, the one
    /// that is being compressed and the one before it.
    static constexpr std::size_t copies_on_the_way = 5;

    /// Binds. Throws as make_tcp_listener() and make_unix_listener(). Clients are accepted from start() on. `status`
    /// gives the daemon's, without the clients; `requests` are what clients may ask for beside it. Both are called in
    /// the server's thread.
    SocketServer(const SocketServerConfig& config, std::function<v1::Status()> status, Requests requests);
    ~SocketServer();
    SocketServer(const SocketServer&) = delete;
    SocketServer& operator=(const SocketServer&) = delete;

    /// Starts to serve. Throws if the thread cannot be started.
    void start();

    /// Closes all connections and joins the thread. Safe to call twice.
    void stop();

    /// Changes addresses and limits; clients stay connected. Throws as the constructor, without any change. Called by
    /// the thread that calls start() and stop(). A longer client_queue takes effect at the next set_layout().
    void reconfigure(const SocketServerConfig& config);

    /// Sets the layout of the frames from now on. Same thread as reconfigure(), while no thread publishes; also before
    /// start().
    void set_layout(const StreamLayout& layout);

    /// Publishes a frame of that layout. One thread at a time; allocates nothing while no client wants frames.
    void publish(const PublishedFrame& frame);

    /// Publishes samples of the camera's sensors, the last one measured at `newest`. One thread at a time; never waits,
    /// allocates nothing while no client wants them. If the server is too busy, samples are lost; `lost_before` of the
    /// next one counts them.
    void publish_sensors(std::span<const capture::SensorSample> samples, SensorRing::Time newest);

    /// Returns the addresses that are served, with the ports as bound: "tls:..." where TCP is encrypted. Same thread as
    /// reconfigure().
    std::vector<std::string> addresses() const;

    /// Returns the address whose file was removed or replaced; empty if there is none. Same thread as reconfigure().
    std::string lost_address() const;

    /// Makes the file of lost_address() again; clients stay connected. Throws as make_unix_listener(). Same thread as
    /// reconfigure().
    void restore();

    /// Returns how long the server's thread has not answered. Each call asks again, once the last one is answered. One
    /// thread.
    std::chrono::nanoseconds silence();

    /// Returns whether a client has subscribed to products of frames. Any thread.
    bool wants_frames() const { return clients_.wanted() != 0; }

    /// Returns how many clients have disconnected since the start. Any thread.
    std::uint64_t gone() const { return clients_.gone(); }

    /// Returns how many frames no client was offered because all copies were in use. Any thread.
    std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

private:
    using Listeners = std::vector<std::shared_ptr<Listener>>;

    void serve(Listener& listener);
    Listeners make_listeners(const SocketServerConfig& config, const Listeners& kept);
    Requests with_status(Requests requests);
    v1::Status status_and_losses() const;
    void watch_clients();
    void run();
    void end_all() noexcept;

    boost::asio::io_context io_{1};
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_;
    std::function<v1::Status()> status_;
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
    std::atomic<std::size_t> samples_on_the_way_{0};
    std::atomic<std::uint64_t> lost_{0};
    std::atomic<bool> answered_{true};

    // The server thread's.
    Listeners serving_;
    boost::asio::steady_timer watch_timer_;
    std::chrono::milliseconds watch_interval_;
    boost::asio::thread_pool compressing_ = one_thread();
    Clients clients_;
};

}  // namespace disparityd::daemon
