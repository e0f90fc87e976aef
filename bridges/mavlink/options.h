// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "bridges/mavlink/bridge.h"
#include "bridges/mavlink/level_giver.h"
#include "bridges/mavlink/link.h"
#include "bridges/mavlink/scan_source.h"
#include "clients/command_line/daemon_arguments.h"

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::mavlink {

/// What the command line says.
struct Options {
    clients::DaemonArguments daemon;
    std::string udp;                ///< HOST:PORT, or empty
    std::string serial;             ///< DEVICE:BAUD, or empty; one of the two is given
    unsigned system_id = 1;         ///< 1 .. 255
    unsigned component_id = 196;    ///< 1 .. 255; MAV_COMP_ID_OBSTACLE_AVOIDANCE
    double rate = 15;               ///< scans per second that are sent at most
    std::int64_t max_age_ms = 300;  ///< an older scan is not sent
    double min_distance_m = 0.2;
    double max_distance_m = 8;
    bool hidden_as_obstacle = false;        ///< see DistanceLimits
    bool send_3d = false;                   ///< OBSTACLE_DISTANCE_3D beside OBSTACLE_DISTANCE
    bool attitude = false;                  ///< the daemon is told the autopilot's attitude
    std::optional<double> camera_height_m;  ///< above the ground, for OBSTACLE_DISTANCE_3D

    /// Adds the options to the program; they are set when it parses.
    void add_to(CLI::App& app);

    /// The following throw std::invalid_argument with one line: what, found, allowed.
    BridgeSettings settings() const;
    std::unique_ptr<Link> make_link() const;
    std::unique_ptr<ScanSource> make_source() const;
    std::unique_ptr<LevelGiver> make_giver() const;  ///< null without `attitude`
};

}  // namespace disparityd::mavlink
