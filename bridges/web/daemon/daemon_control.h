// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/thread_pool.hpp>

#include "bridges/web/daemon/daemon_link.h"

namespace disparityd::web {

/// What the daemon answered.
struct ControlAnswer {
    bool done = false;
    std::string text;  ///< JSON of what was asked, or one line: why not
};

/// Sends requests to the daemon, each over a connection of its own, in threads of its own: closing a recording may take
/// a minute. The network's thread calls it; `answer` is called in one of its threads.
class DaemonControl {
public:
    using Answer = std::function<void(ControlAnswer)>;

    explicit DaemonControl(DaemonAddress daemon) : daemon_(std::move(daemon)), threads_(2) {}
    /// Waits for the requests under way; those that wait for a thread are dropped.
    ~DaemonControl() {
        threads_.stop();
        threads_.join();
    }

    /// Sets controls of the camera, in this order (none: only asks).
    void set_controls(const std::vector<std::pair<std::string, std::int64_t>>& settings, Answer answer);
    void start_recording(const std::string& path, Answer answer);
    void stop_recording(Answer answer);

private:
    using Request = std::function<std::string(disparity::SocketClient&)>;
    void ask(Request request, Answer answer);

    DaemonAddress daemon_;
    boost::asio::thread_pool threads_;
};

}  // namespace disparityd::web
