// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "tools/ctl/daemon.h"

namespace disparityd::tools {

/// What the command line asks for.
struct McapRecordArguments {
    DaemonArguments daemon;
    std::string file;
    std::string contents;  ///< empty: the usual ones
    std::string camera = "stereo";
    std::optional<int> seconds;
    std::optional<int> frames;
    bool force = false;
    bool json = false;
};

/// What a file gets unless the command line says otherwise.
inline constexpr const char* usual_recorded_parts = "rectified,disparity,depth,imu,tf";

/// Writes what a running daemon sends into an MCAP file, until the limit or a signal; returns the exit status. Reading
/// never waits for the disk: where it is too slow, the newest frames win. Throws std::invalid_argument when the user
/// must change something, std::runtime_error when the daemon or the system refuses, both before the first frame.
int record_mcap(const McapRecordArguments& arguments);

}  // namespace disparityd::tools
