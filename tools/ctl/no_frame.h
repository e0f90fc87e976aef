// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/ctl/daemon_address.h"

namespace disparityd::tools {

/// Returns why no frames come, from the daemon's status: "the daemon is preparing its source", "the source has ended
/// ..."; where its socket does not answer, the command that shows more. Takes up to 5 s where the daemon hangs.
std::string why_no_frame(const DaemonAddress& daemon);

}  // namespace disparityd::tools
