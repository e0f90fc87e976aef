// SPDX-License-Identifier: Apache-2.0
//
// Sends the daemon's obstacle scans to an autopilot, as MAVLink 2.
#include <atomic>
#include <csignal>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "bridges/mavlink/bridge.h"
#include "bridges/mavlink/options.h"
#include "bridges/program/program.h"

namespace {

using namespace disparityd::mavlink;

constexpr const char* program = "disparity-mavlink";

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "signal handlers need lock-free atomics");

extern "C" void on_signal(int /*number*/) {
    stop.store(true, std::memory_order_relaxed);
}

/// The first SIGTERM or SIGINT ends the program in order, a second one at once.
void catch_signals() {
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGTERM, &action, nullptr);
    sigaction(SIGINT, &action, nullptr);
}

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
    catch_signals();
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
