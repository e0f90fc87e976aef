// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/ctl/daemon_address.h"

namespace disparityd::tools {

/// Returns why no frames come, from the daemon's status: "the daemon is preparing its source", "the source has ended
/// ..."; where the socket that frames come from does not answer, what is wrong with it; where no other socket answers,
/// the command that shows more. Takes up to 1 s to connect where the daemon hangs, and 1 s more if it hangs after that.
std::string why_no_frame(const DaemonAddress& daemon);

}  // namespace disparityd::tools
