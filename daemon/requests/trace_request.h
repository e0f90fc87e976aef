// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "daemon/engine.h"

namespace disparityd::daemon {

/// Takes traces of the running engine for clients, one at a time. Its work is done in the thread that runs `control`.
class TraceService {
public:
    /// Called in that thread, or in that of ask(). Without a refusal there is at least one part.
    using Parts = std::shared_ptr<const std::vector<v1::Trace>>;
    using Answer = std::function<void(Parts parts, const std::string& refusal)>;

    static constexpr double least_seconds = 0.1;
    static constexpr double most_seconds = 10;

    /// `engine` gives the running engine or nullptr; any thread.
    TraceService(boost::asio::io_context& control, std::function<std::shared_ptr<Engine>()> engine)
        : control_(control), timer_(control), engine_(std::move(engine)) {}
    TraceService(const TraceService&) = delete;
    TraceService& operator=(const TraceService&) = delete;

    /// Starts a trace; the answer comes when it has ended. Any thread.
    void ask(const v1::TraceRequest& request, Answer answer);

private:
    void begin(std::chrono::steady_clock::duration time);
    void end();
    void refuse(const std::string& why);
    Answer take_answer();

    boost::asio::io_context& control_;
    boost::asio::steady_timer timer_;
    std::function<std::shared_ptr<Engine>()> engine_;
    std::weak_ptr<Engine> traced_;  ///< of the control thread; not owned: a reload frees the engine before it
    std::mutex mutex_;              ///< the next one
    Answer answer_;                 ///< of the trace that is being taken; empty = none is
};

}  // namespace disparityd::daemon
