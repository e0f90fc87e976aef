// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace disparityd::web {

/// Finds daemons by the sockets that they have in some folders. One that hangs is found too, and one that was killed
/// since it was found; what was left behind before is not. One thread at a time.
class SocketScan {
public:
    /// The first of the folders is the system's: all its sockets count. In others only those of this user and of root.
    explicit SocketScan(std::vector<std::string> folders) : folders_(std::move(folders)) {}

    /// Returns the names of the daemons. Reads a folder only where it has changed since: without a change, it costs one
    /// look at each folder's time. A socket is connected to until somebody listens there.
    const std::set<std::string>& names();

private:
    using Clock = std::chrono::system_clock;

    struct Known {
        Clock::time_point changed;  ///< the folder's time when it was read; the epoch: it is not there
        bool settled = false;       ///< a change after it was read has another time
        std::set<std::string> names;
    };

    bool refresh(const std::string& folder, bool of_the_system);
    bool is_daemon(const std::string& name, const std::string& path, bool of_the_system);

    std::vector<std::string> folders_;
    std::map<std::string, Known> known_;
    std::set<std::string> all_;
    std::set<std::string> seen_;  ///< those at whose sockets somebody has listened
};

/// Returns one line: that there is no daemon in these folders, the likely cause, what to do.
std::string why_no_daemon(const std::vector<std::string>& folders);

/// Looks for daemons once a second, in a thread of its own.
class DaemonWatch {
public:
    /// `on_names` is called in the watch's thread when the names have changed, and at the start. A name is one that a
    /// page's address can have.
    DaemonWatch(std::vector<std::string> folders, std::function<void(std::set<std::string>)> on_names);
    ~DaemonWatch();
    DaemonWatch(const DaemonWatch&) = delete;
    DaemonWatch& operator=(const DaemonWatch&) = delete;

    /// Tells the thread to end, and does not wait for it; any thread.
    void stop();

private:
    void run();

    SocketScan scan_;
    const std::function<void(std::set<std::string>)> on_names_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace disparityd::web
