// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bridges/ros2/bridge.h"
#include "bridges/ros2/node.h"
#include "clients/command_line/daemon_arguments.h"

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::ros2 {

/// What the command line says.
struct Options {
    clients::DaemonArguments daemon;
    std::string names = "image_pipeline";  ///< or "zed"
    std::string camera_name = "stereo";    ///< prefix of frames, and the namespace's default
    std::string name_space;                ///< of topics; empty: the default
    std::string node_name = "disparity_ros2";
    std::string reliability = "reliable";  ///< or "best-effort"
    std::string durability = "volatile";   ///< or "transient-local"
    int depth = 5;                         ///< 1 .. 1000
    bool list_topics = false;              ///< say what is published, and end
    bool clock = false;
    bool humble = false;
    bool no_tf = false;
    std::string parent_frame;  ///< empty: the camera is the root
    std::string scan_frame;    ///< empty: the camera's own
    ros::Place place;
    std::string points = "organised";  ///< or "packed"
    unsigned most_points = 20000;
    double points_rate = 10;
    double voxel_m = 0;
    std::string box;                       ///< six numbers with commas between, or empty
    std::string scan_hidden = "obstacle";  ///< or "ignored"
    int jpeg_quality = 85;
    std::string compressed_depth = "png";  ///< or "rvl"

    /// Adds the options to the program; they are set when it parses.
    void add_to(CLI::App& app);

    /// The following throw std::invalid_argument with one line: what, found, allowed.
    BridgeSettings settings() const;
    NodeName node() const;
    DaemonPlace place_of_daemon() const;
};

}  // namespace disparityd::ros2
