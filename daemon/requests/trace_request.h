// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "daemon/engine.h"
#include "daemon/requests/request.h"

namespace disparityd::daemon {

/// Takes traces of the running engine, one at a time, for all clients that may look: the next one when the client has
/// got the one before. Its work is done in the thread that runs `control`.
class TraceService {
public:
    static constexpr double least_seconds = 0.1;
    static constexpr double most_seconds = 10;
    /// A trace takes at most so much memory: its events as recorded, as messages, and as bytes for the client.
    static constexpr std::size_t max_bytes = std::size_t{64} << 20;

    /// `engine` gives the running engine or nullptr; any thread.
    TraceService(boost::asio::io_context& control, std::function<std::shared_ptr<Engine>()> engine)
        : control_(control), timer_(control), engine_(std::move(engine)) {}
    TraceService(const TraceService&) = delete;
    TraceService& operator=(const TraceService&) = delete;

    /// Starts a trace; the reply, of several messages, comes when it has ended. Any thread.
    void ask(const v1::TraceRequest& request, Reply reply);

private:
    void begin(std::chrono::steady_clock::duration time);
    void end();
    void refuse(const std::string& why);
    Reply take_reply();

    boost::asio::io_context& control_;
    boost::asio::steady_timer timer_;
    std::function<std::shared_ptr<Engine>()> engine_;
    std::weak_ptr<Engine> traced_;          ///< of the control thread; not owned: a reload frees the engine before it
    std::mutex mutex_;                      ///< the next two
    Reply reply_;                           ///< of the trace that is being taken; empty = none is
    std::weak_ptr<const void> on_its_way_;  ///< held for the answer until its client has got it
};

/// Returns the request of clients, which `trace` must outlive.
Request trace_request(TraceService& trace);

}  // namespace disparityd::daemon
