// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <list>
#include <mutex>
#include <string>

#include <boost/asio/thread_pool.hpp>

namespace disparityd::web {

/// Runs jobs in one thread. Each peer's jobs run in their order, and peers take turns: one that has many jobs, over
/// many connections, does not make another wait for more than one of them.
class EncodingTurns {
public:
    using Job = std::function<void()>;

    /// Any thread. A job does not throw.
    void add(const std::string& peer, Job job);

    /// Runs what is there, and ends the thread.
    void join() { thread_.join(); }

private:
    struct Peer {
        std::string name;
        std::deque<Job> jobs;  ///< never empty
    };

    void run_next();

    std::mutex mutex_;
    std::list<Peer> waiting_;             ///< the one whose turn it is first
    boost::asio::thread_pool thread_{1};  ///< ends before what it uses
};

}  // namespace disparityd::web
