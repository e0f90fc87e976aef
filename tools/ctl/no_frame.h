// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "tools/ctl/daemon.h"

namespace disparityd::tools {

/// Returns why no frames come, from the daemon's status: "the daemon is preparing its source", "the source has ended
/// ..."; where the socket that frames come from does not answer, what is wrong with it; where no other socket answers,
/// the command that shows more. Takes up to 1 s to connect where the daemon hangs, and 1 s more if it hangs after that.
std::string why_no_frame(const DaemonArguments& daemon);

/// Returns whether the daemon answers and says that its source has ended: the newest frame is the last one.
bool source_has_ended(const DaemonArguments& daemon);

/// Returns "12.3 s".
std::string seconds_text(std::chrono::nanoseconds time);

}  // namespace disparityd::tools
