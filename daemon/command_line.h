// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/daemon.h"

namespace disparityd::daemon {

struct CommandLine {
    DaemonOptions daemon;
    bool check = false;  ///< only check whether this machine can run the configuration
};

/// Reads the command line. Returns nothing when --help or --version was answered on standard output. Throws
/// std::invalid_argument with one line when an argument is wrong.
std::optional<CommandLine> read_command_line(int argc, const char* const* argv);

}  // namespace disparityd::daemon
