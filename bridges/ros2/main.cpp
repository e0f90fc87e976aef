// SPDX-License-Identifier: Apache-2.0
//
// Publishes what the daemon measures to nodes of ROS 2, over DDS.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <CLI/CLI.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "bridges/program/program.h"
#include "bridges/program/stop_signals.h"
#include "bridges/ros2/bridge.h"
#include "bridges/ros2/dds_log.h"
#include "bridges/ros2/options.h"
#include "bridges/ros2/topic_list.h"

namespace {

using namespace disparityd::ros2;
using disparityd::bridges::print_line;

constexpr const char* program = "disparity-ros2";

std::string environment(const std::string& name) {
    const char* const value = std::getenv(name.c_str());
    return value == nullptr ? std::string() : value;
}

/// Returns how many bytes of datagrams on their way the system grants at most: SO_RCVBUF or SO_SNDBUF of a socket that
/// asks for a lot. 0: it does not say.
std::uint64_t granted_bytes(int option) {
    const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    int bytes = 1 << 30;
    socklen_t size = sizeof bytes;
    ::setsockopt(fd, SOL_SOCKET, option, &bytes, size);
    const bool told = ::getsockopt(fd, SOL_SOCKET, option, &bytes, &size) == 0;
    ::close(fd);
    return told ? static_cast<std::uint64_t>(bytes) / 2 : 0;  // the kernel counts its own needs as much again
}

void run(const Options& options) {
    BridgeSettings settings = options.settings();
    if (options.list_topics) {
        std::fputs(topic_list(settings).c_str(), stdout);
        return;
    }
    const Domain domain = domain_of(environment);
    const auto print = [](const std::string& line) { print_line(program, "note", line); };
    disparityd::bridges::Notes notes(print);
    DdsLog log(print);
    Node node(options.node(), domain);
    log.calm();
    if (const std::string line = small_buffers_text(granted_bytes(SO_RCVBUF), granted_bytes(SO_SNDBUF));
        !line.empty()) {
        print_line(program, "note", line);
    }
    Bridge bridge(std::move(settings), options.place_of_daemon(), node, notes);
    const std::atomic<bool>& stop = disparityd::bridges::catch_stop_signals();
    bridge.run(stop);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app(
        "Publishes images, depth, points, obstacle scans and inertial data of a running disparityd to nodes of ROS 2, "
        "over DDS; no ROS is needed here. Only what somebody subscribes to is computed. The daemon may come and go. "
        "ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS and CYCLONEDDS_URI say "
        "where "
        "nodes are looked for, as for any node.",
        program);
    Options options;
    options.add_to(app);
    app.footer(
        "Examples: disparity-ros2 --camera-name front --parent-frame base_link --height-m 0.3\n"
        "          disparity-ros2 --names zed --camera-name zed\n"
        "Exit status: 0 SIGTERM or Ctrl-C ended it; 1 the system refuses; 2 an argument is wrong.");
    return disparityd::bridges::run_program(app, argc, argv, [&options] { run(options); });
}
