// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "tools/ctl/mcap/ros_mcap.h"

namespace disparityd::tools {

/// What was written into an MCAP file, for the end of a command.
struct McapReport {
    std::string file;
    std::uint64_t frames = 0;
    std::uint64_t messages = 0;
    std::uint64_t bytes = 0;
    std::map<std::string, std::uint64_t> topics = {};  ///< messages of each
    std::optional<std::uint64_t> dropped = {};         ///< frames that were not written, of a daemon that does not wait
    std::optional<std::uint64_t> dropped_samples = {};
    std::optional<std::uint64_t> dropped_before = {};  ///< frames between these that the daemon itself never published
    std::optional<std::uint64_t> without_camera_info = {};  ///< frames whose raw images have none
    std::string error = {};                                 ///< why it ended early; empty: it did not
    bool disk_full = false;
    bool interruption_is_usual = false;  ///< as where only a signal ends it

    /// Takes what the file has; nothing: none was made.
    void take(const std::optional<RosMcap>& written);

    /// Prints the summary, as one JSON object or for people, and what went wrong; returns the exit status.
    int tell(bool json) const;
};

}  // namespace disparityd::tools
