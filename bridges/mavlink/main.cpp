// SPDX-License-Identifier: Apache-2.0
//
// Sends the daemon's obstacle scans to an autopilot, as MAVLink 2.
#include <atomic>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "bridges/mavlink/bridge.h"
#include "bridges/mavlink/options.h"
#include "bridges/program/program.h"
#include "bridges/program/stop_signals.h"

namespace {

using namespace disparityd::mavlink;

constexpr const char* program = "disparity-mavlink";

void run(const Options& options) {
    const BridgeSettings settings = options.settings();
    const auto link = options.make_link();
    const auto source = options.make_source();
    const auto giver = options.make_giver();
    std::optional<AttitudeRelay> attitude;
    if (giver) {
        attitude.emplace(settings.system_id, *giver);
    }
    Notes notes([](const std::string& line) { disparityd::bridges::print_line(program, "note", line); });
    const std::atomic<bool>& stop = disparityd::bridges::catch_stop_signals();
    Bridge(settings, *source, *link, notes, attitude ? &*attitude : nullptr).run(stop);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app(
        "Sends the obstacle scans of a running disparityd to an autopilot, as MAVLink 2: OBSTACLE_DISTANCE, a "
        "HEARTBEAT every second and, with --3d, OBSTACLE_DISTANCE_3D. With --attitude it tells the daemon the "
        "vehicle's attitude. The daemon needs [scan] enabled = true. "
        "It may come and go; so may the link.",
        program);
    Options options;
    options.add_to(app);
    app.footer(
        "Examples: disparity-mavlink --udp 127.0.0.1:14550\n"
        "          disparity-mavlink --serial /dev/ttyACM0:921600 --max-distance-m 12 --3d --camera-height-m 0.3\n"
        "Exit status: 0 SIGTERM or Ctrl-C ended it; 1 the system refuses; 2 an argument is wrong.");
    return disparityd::bridges::run_program(app, argc, argv, [&options] { run(options); });
}
