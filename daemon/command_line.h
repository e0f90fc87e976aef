// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/daemon.h"

namespace disparityd {

struct CommandLine {
    DaemonOptions daemon;
    bool check = false;  ///< only say whether this machine can run the configuration
};

/// Reads the command line. Empty when --help or --version was answered on standard output. Throws std::invalid_argument
/// with one line for what is not understood.
std::optional<CommandLine> read_command_line(int argc, const char* const* argv);

}  // namespace disparityd
