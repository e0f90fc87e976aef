// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "daemon/engine.h"
#include "daemon/requests/request.h"

namespace disparityd::daemon {

/// Where up is, as an autopilot tells it: changes what scans report, so only clients that may control give it.
/// Answered at once. `engine` gives the running engine or nullptr; any thread.
Request level_request(std::function<std::shared_ptr<Engine>()> engine);

}  // namespace disparityd::daemon
