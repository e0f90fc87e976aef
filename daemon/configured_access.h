// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/config/config.h"
#include "daemon/socket/client_access.h"
#include "proto/tls/tls_context.h"

namespace disparityd::daemon {

/// Returns who may look and control: reads the tokens and finds the groups. Throws std::invalid_argument with one line:
/// key or file, found, allowed.
ClientAccess client_access(const Config& config);

/// Reads certificate, key and authority of [socket]; null where no certificate is configured. Throws
/// std::invalid_argument with one line, also where every user may read the key.
proto::TlsContext client_tls(const Config& config);

}  // namespace disparityd::daemon
