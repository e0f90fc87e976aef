// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "bridges/web/daemon/daemon_control.h"
#include "bridges/web/daemon/frame_feed.h"
#include "bridges/web/daemon/hub.h"
#include "bridges/web/daemon/status_feed.h"
#include "bridges/web/http/daemon_routes.h"
#include "bridges/web/http/destination.h"

namespace disparityd::web {

/// One daemon and all that reads it, in threads of its own: one that hangs holds no other. The network's thread owns
/// it.
class ServedDaemon {
public:
    /// How often the status is asked for while nobody wants each one.
    enum class Unwatched { as_usual, seldom };

    ServedDaemon(const ServerParts& parts, const DaemonAddress& address, Unwatched unwatched);

    /// Says whether the daemon may be there. While not, it is told to be gone for this reason and left alone.
    void set_present(bool present, const std::string& why = {});

    const DaemonState& state() const { return hub_.state(); }
    /// `prefix`: as Destination has it.
    Destination destination(std::size_t prefix) { return {&place_, &routes_, prefix}; }

    /// Tells the threads to end, and does not wait for them.
    void stop();

private:
    void on_wants(const Wants& wants);
    void on_state(const DaemonState& state);

    Unwatched unwatched_;
    bool present_ = true;
    Hub hub_;
    Workplace place_;
    DaemonControl control_;
    DaemonRoutes routes_;
    FrameFeed frames_;
    StatusFeed statuses_;
};

/// The only daemon of a server.
class OneDaemon : public ServedDaemons {
public:
    OneDaemon(const ServerParts& parts, const DaemonAddress& address)
        : daemon_(parts, address, ServedDaemon::Unwatched::as_usual) {}

    Destination destination(std::string_view /*path*/) override { return daemon_.destination(0); }
    void stop() override { daemon_.stop(); }

private:
    ServedDaemon daemon_;
};

}  // namespace disparityd::web
