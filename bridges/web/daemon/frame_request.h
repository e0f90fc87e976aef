// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <set>

#include <boost/asio/steady_timer.hpp>

#include "bridges/web/daemon/hub.h"

namespace disparityd::web {

/// Waits for one frame with these products, for a snapshot. The network's thread calls it.
class FrameRequest : public Listener, public std::enable_shared_from_this<FrameRequest> {
public:
    using Answer = std::function<void(std::shared_ptr<const LiveFrame>)>;

    /// Calls `answer` once, with the first frame that has all the `needed` products, or with nullptr after 3 s. Frames
    /// have the `welcome` ones, too, where the daemon serves them.
    static void start(boost::asio::io_context& network, Hub& hub, std::set<disparity::Product> needed,
                      const std::set<disparity::Product>& welcome, Answer answer);

    void on_frame(const std::shared_ptr<const LiveFrame>& frame) override;
    void on_state(const DaemonState&) override {}
    void on_sensors(const disparity::SensorBatch&) override {}
    Wants wants() const override;

private:
    FrameRequest(boost::asio::io_context& network, Hub& hub) : hub_(hub), timer_(network) {}
    void finish(const std::shared_ptr<const LiveFrame>& frame);

    Hub& hub_;
    boost::asio::steady_timer timer_;
    std::set<disparity::Product> needed_;
    std::set<disparity::Product> wanted_;
    Answer answer_;
};

}  // namespace disparityd::web
