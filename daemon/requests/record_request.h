// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/requests/request.h"

namespace disparityd::daemon {

class RecordingControl;

/// Starts and ends a recording, for clients that may control. RecordingControl has the rules about folder, owner, rate
/// and room on the disk; it must outlive the requests. A recording goes on for the client that has started it.
Request record_start_request(RecordingControl& recording);
Request record_stop_request(RecordingControl& recording);

}  // namespace disparityd::daemon
