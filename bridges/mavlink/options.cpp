// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/options.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "bridges/program/host_and_port.h"
#include "bridges/program/number_range.h"

namespace disparityd::mavlink {
namespace {

/// What every system's serial ports know.
constexpr std::array baud_rates{9600U,   19200U,  38400U,   57600U,   115200U,  230400U,  460800U, 500000U,
                                576000U, 921600U, 1000000U, 1152000U, 1500000U, 2000000U, 3000000U};

using bridges::between;

[[noreturn]] void refuse(const std::string& option, const std::string& text, const std::string& form) {
    throw std::invalid_argument(option + ": found \"" + text + "\", expected " + form);
}

std::unique_ptr<Link> make_udp(const std::string& text) {
    const auto to = bridges::parse_host_and_port(text);
    if (!to) {
        refuse("--udp", text, "HOST:PORT, such as 127.0.0.1:14550");
    }
    if (to->number < 1 || to->number > 65535) {
        throw std::invalid_argument("--udp: found port " + std::to_string(to->number) + ", allowed: 1 .. 65535");
    }
    return udp_link(to->name, static_cast<std::uint16_t>(to->number));
}

std::unique_ptr<Link> make_serial(const std::string& text) {
    const auto to = bridges::parse_name_and_number(text);
    if (!to) {
        refuse("--serial", text, "DEVICE:BAUD, such as /dev/ttyACM0:921600");
    }
    if (!is_baud_rate(to->number)) {
        std::string allowed;
        for (const unsigned baud : baud_rates) {
            allowed += (allowed.empty() ? "" : ", ") + std::to_string(baud);
        }
        throw std::invalid_argument("--serial: found " + std::to_string(to->number) + " baud, allowed: " + allowed);
    }
    return serial_link(to->name, to->number);
}

/// Returns the limits of the message in whole cm: not narrower than the user's, and at least one apart.
DistanceLimits limits_of(const Options& options) {
    DistanceLimits limits;
    limits.min_cm = static_cast<std::uint16_t>(std::floor(options.min_distance_m * 100 + 1e-6));
    limits.hidden_as_obstacle = options.hidden_as_obstacle;
    limits.max_cm = static_cast<std::uint16_t>(std::ceil(options.max_distance_m * 100 - 1e-6));
    if (limits.min_cm >= limits.max_cm) {
        std::ostringstream text;
        text << "--min-distance-m: found " << options.min_distance_m
             << ", allowed: less than --max-distance-m, which is " << options.max_distance_m;
        throw std::invalid_argument(text.str());
    }
    return limits;
}

void add_autopilot(CLI::App& app, Options& options) {
    const std::string group = "Which autopilot";
    CLI::Option* const udp = app.add_option("--udp", options.udp, "Send datagrams to HOST:PORT");
    udp->type_name("HOST:PORT")->group(group);
    app.add_option("--serial", options.serial, "Send to a serial device, such as /dev/ttyACM0:921600")
        ->type_name("DEVICE:BAUD")
        ->excludes(udp)
        ->group(group);
    app.add_option("--system-id", options.system_id, "MAVLink system that this is a part of: the vehicle's")
        ->type_name("NUMBER")
        ->check(between(1, 255))
        ->capture_default_str()
        ->group(group);
    app.add_flag(
           "--attitude", options.attitude,
           "Tell the daemon the attitude of this system's autopilot, for [scan] ground = \"autopilot\"; the daemon "
           "must let this program control")
        ->group(group);
    app.add_option("--component-id", options.component_id, "MAVLink component that this is; 196 avoids obstacles")
        ->type_name("NUMBER")
        ->check(between(1, 255))
        ->capture_default_str()
        ->group(group);
}

void add_contents(CLI::App& app, Options& options) {
    const std::string group = "What is sent";
    app.add_option("--rate", options.rate, "Scans per second at most")
        ->type_name("NUMBER")
        ->check(between(0.1, 100))
        ->capture_default_str()
        ->group(group);
    app.add_option("--max-age-ms", options.max_age_ms, "A scan that is older than this is not sent")
        ->type_name("NUMBER")
        ->check(between(10, 2000))
        ->capture_default_str()
        ->group(group);
    app.add_option(
           "--max-distance-m", options.max_distance_m,
           "A sector is sent as free when it is free up to here, with less as unknown; obstacles beyond are not sent")
        ->type_name("NUMBER")
        ->check(between(0.5, 650))
        ->capture_default_str()
        ->group(group);
    app.add_option("--min-distance-m", options.min_distance_m,
                   "Obstacles that are nearer are sent as at this distance: autopilots ignore nearer ones")
        ->type_name("NUMBER")
        ->check(between(0.01, 100))
        ->capture_default_str()
        ->group(group);
    app.add_flag("--hidden-as-obstacle", options.hidden_as_obstacle,
                 "Send an obstacle as being where something may hide before it, in OBSTACLE_DISTANCE: for PX4 and for "
                 "vehicles that only stop; ArduPilot may back away from what nobody saw")
        ->group(group);
    app.add_flag("--3d", options.send_3d, "Also send OBSTACLE_DISTANCE_3D, one for each occupied sector (ArduPilot)")
        ->group(group);
    app.add_option("--camera-height-m", options.camera_height_m,
                   "With --3d: the camera's height above the ground, [scan] camera_height_m of the daemon; default: "
                   "obstacles are sent as level with the camera")
        ->type_name("NUMBER")
        ->check(between(-10, 100))
        ->group(group);
}

}  // namespace

bool is_baud_rate(unsigned baud) {
    return std::find(baud_rates.begin(), baud_rates.end(), baud) != baud_rates.end();
}

void Options::add_to(CLI::App& app) {
    daemon.add_to(app);
    add_autopilot(app, *this);
    add_contents(app, *this);
}

BridgeSettings Options::settings() const {
    return {.system_id = static_cast<std::uint8_t>(system_id),
            .component_id = static_cast<std::uint8_t>(component_id),
            .rate = rate,
            .max_age = std::chrono::milliseconds(max_age_ms),
            .limits = limits_of(*this),
            .send_3d = send_3d,
            .camera_height_m = camera_height_m};
}

std::unique_ptr<Link> Options::make_link() const {
    if (udp.empty() == serial.empty()) {
        throw std::invalid_argument("found no autopilot, expected --udp HOST:PORT or --serial DEVICE:BAUD");
    }
    return udp.empty() ? make_serial(serial) : make_udp(udp);
}

std::unique_ptr<ScanSource> Options::make_source() const {
    // A little more than is sent, so that none of the right moment is missing.
    return std::make_unique<ScanSource>(daemon.where(), daemon.reach.for_client("disparity-mavlink"), 2 * rate);
}

std::unique_ptr<LevelGiver> Options::make_giver() const {
    return attitude ? std::make_unique<LevelGiver>(daemon.where(), daemon.reach.for_client("disparity-mavlink"))
                    : nullptr;
}

}  // namespace disparityd::mavlink
