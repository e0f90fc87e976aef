// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "bridges/web/images/live_frame.h"
#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"

namespace disparityd::web {

/// What the daemon told last. An object does not change once it is handed out.
struct DaemonState {
    bool there = false;
    std::string why = "asking the daemon";     ///< one line: why it is not there
    std::shared_ptr<const v1::Status> status;  ///< nullptr until it has told one
    std::vector<disparity::Product> products;  ///< that it serves
};

/// Returns one line: that the daemon, which is there, does not serve a product, and what to do; else "".
std::string why_not_served(const DaemonState& state, disparity::Product product);

/// What a connection wants to be told.
struct Wants {
    std::set<disparity::Product> products;  ///< empty = no frames
    bool sensors = false;
    bool status = false;  ///< each status; else the newest is enough, whenever it came
};

/// A connection that is told what comes from the daemon. All calls come from the network's thread.
class Listener {
public:
    virtual ~Listener() = default;
    virtual void on_frame(const std::shared_ptr<const LiveFrame>& frame) = 0;
    virtual void on_state(const DaemonState& state) = 0;
    virtual void on_sensors(const disparity::SensorBatch& batch) = 0;
    virtual Wants wants() const = 0;
};

/// Knows what came last from the daemon, and tells the connections. The network's thread owns it.
class Hub {
public:
    /// `on_wants` is told what all connections together want, of what the daemon serves.
    explicit Hub(std::function<void(const Wants&)> on_wants) : on_wants_(std::move(on_wants)) {}

    /// The hub does not keep a listener alive; one that has ended is left out.
    void add(const std::weak_ptr<Listener>& listener);
    /// A listener calls it when its wants() has changed or it ends.
    void update_wants();

    void on_frame(const std::shared_ptr<const LiveFrame>& frame);
    void on_state(DaemonState state);
    void on_sensors(const disparity::SensorBatch& batch);

    const DaemonState& state() const { return state_; }

private:
    template <typename Call>
    void for_each(const Call& call);

    std::function<void(const Wants&)> on_wants_;
    std::vector<std::weak_ptr<Listener>> listeners_;
    DaemonState state_;
};

}  // namespace disparityd::web
