// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bridges/web/daemon/daemon_control.h"
#include "bridges/web/http/routes.h"
#include "bridges/web/live/live_session.h"

namespace disparityd::web {

/// Answers what is asked about one daemon. The network's thread owns it.
class DaemonRoutes : public Handler {
public:
    DaemonRoutes(const Workplace& workplace, DaemonControl& control) : place_(workplace), control_(control) {}

    void view(const Asked& asked) override;
    std::string trouble() const override;
    std::string_view page() const override { return "/index.html"; }

private:
    void control(const Asked& asked);
    void snapshot(const Asked& asked);
    void make_snapshot(const std::shared_ptr<const Request>& request, const std::string& peer, const Answer& answer,
                       const std::string& type, std::function<std::string()> make);
    void camera(const Asked& asked);
    void recording(const Asked& asked);
    std::function<void(ControlAnswer)> to_answer(const Asked& asked);

    Workplace place_;
    DaemonControl& control_;
    int requests_under_way_ = 0;  ///< to the daemon
    int snapshots_under_way_ = 0;
};

/// Returns one line: why a daemon gives no frames, as /healthz tells it; "" where it runs, or is idle.
std::string why_not_running(const DaemonState& state);

}  // namespace disparityd::web
