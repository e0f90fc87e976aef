// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/requests/request.h"

namespace disparityd::daemon {

/// How the daemon stands. Every client that may look may ask; it is answered at once.
Request status_request(std::function<v1::Status()> status);

}  // namespace disparityd::daemon
