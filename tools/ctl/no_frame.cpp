// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/no_frame.h"

#include <stdexcept>

#include "tools/ctl/status_message.h"

namespace disparityd::tools {

std::string why_no_frame(const DaemonAddress& daemon) {
    try {
        disparity::SocketClient client = connect(daemon);
        const v1::Status status = daemon_status(client);
        if (!status.detail().empty()) {
            return status.detail();
        }
        if (status.state() != "running") {
            return "the daemon is " + status.state();
        }
    } catch (const std::runtime_error&) {
        // Frames may come over shared memory where no socket is known.
    }
    return daemon.command("status") + " says more";
}

}  // namespace disparityd::tools
