// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>

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

    /// Throws as base::start_thread().
    explicit DaemonControl(DaemonAddress daemon);
    /// Waits for the requests under way; those that wait for a thread are dropped.
    ~DaemonControl() { end(); }
    DaemonControl(const DaemonControl&) = delete;
    DaemonControl& operator=(const DaemonControl&) = delete;

    /// Sets controls of the camera, in this order (none: only asks).
    void set_controls(const std::vector<std::pair<std::string, std::int64_t>>& settings, Answer answer);
    void start_recording(const std::string& path, Answer answer);
    void stop_recording(Answer answer);

private:
    using Request = std::function<std::string(disparity::SocketClient&)>;
    void ask(Request request, Answer answer);
    void end();

    DaemonAddress daemon_;
    // Not a thread_pool: where the system refuses its second thread, that waits for the first one for ever.
    boost::asio::io_context requests_;
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> open_{requests_.get_executor()};
    std::vector<std::thread> threads_;
};

}  // namespace disparityd::web
