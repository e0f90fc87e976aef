// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <iostream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "base/message_text.h"
#include "base/words.h"
#include "tools/command_line/table.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/daemon.h"
#include "tools/ctl/describe.h"

namespace disparityd::tools {
namespace {

struct StatusArguments {
    DaemonArguments daemon;
    bool json = false;
};

void print_row(const std::string& what, const std::string& value) {
    constexpr std::size_t column = 12;
    if (!value.empty()) {
        std::cout << what << std::string(column - std::min(what.size(), column - 1), ' ')
                  << base::printable(value, value.size()) << '\n';
    }
}

std::string geometry_text(const v1::Geometry& geometry) {
    std::string text = std::to_string(geometry.width()) + " x " + std::to_string(geometry.height()) + " px";
    if (geometry.f() > 0) {
        text += ", f " + fixed(geometry.f(), 1) + " px";
    }
    if (geometry.baseline_mm() > 0) {
        text += ", baseline " + fixed(geometry.baseline_mm(), 2) + " mm";
    }
    const int last = geometry.d_min() + static_cast<int>(geometry.disparities()) - 1;
    return text + ", disparities " + std::to_string(geometry.d_min()) + " .. " + std::to_string(last);
}

std::string record_text(const v1::RecordStatus& record) {
    if (record.path().empty()) {
        return {};
    }
    return record.path() + ": " + (record.active() ? "running, " : "finished, ") +
           base::counted(record.frames(), "frame") + ", " + std::to_string(record.dropped()) + " dropped, " +
           (record.lost() > 0 ? std::to_string(record.lost()) + " lost by the source, " : "") +
           fixed(static_cast<double>(record.bytes()) / 1e6, 1) + " MB" +
           (record.removed() ? ", removed, as it had no frame" : "") +
           (record.error().empty() ? "" : ", error: " + record.error());
}

std::string self_calibration_text(const v1::SelfCalibration& status) {
    std::string text = "nothing changed";
    if (status.corrected()) {
        text = "corrected since frame " + std::to_string(status.since_sequence()) + ": pitch " +
               fixed(status.pitch_degrees(), 3) + ", roll " + fixed(status.roll_degrees(), 3) + " degrees";
    }
    if (status.error_before_px() > 0) {
        text += "; vertical error " + fixed(status.error_before_px(), 2) + " px";
        text += status.error_after_px() > 0 ? ", now " + fixed(status.error_after_px(), 2) + " px" : "";
    }
    return text + (status.detail().empty() ? "" : "; " + status.detail());
}

std::string camera_text(const v1::CameraStatus& camera) {
    if (camera.model().empty()) {
        return camera.state();
    }
    std::string text = camera.state() + ", " + camera.model() + (camera.serial().empty() ? "" : ", serial ") +
                       camera.serial() + (camera.node().empty() ? "" : ", ") + camera.node();
    if (camera.speed_mbit() > 0) {
        text += ", USB " + fixed(camera.speed_mbit(), 0) + " Mbit/s";
    }
    return text + "; came " + base::counted(camera.arrivals(), "time") + ", " +
           base::counted(camera.restarts(), "restart") + ", " + std::to_string(camera.reopens()) + " reopened, " +
           base::counted(camera.resets(), "USB reset");
}

std::string sensors_text(const v1::SensorStatus& sensors) {
    std::string text = sensors.state() + (sensors.node().empty() ? "" : ", " + sensors.node()) + ", " +
                       base::counted(sensors.samples(), "sample") + ", " + std::to_string(sensors.lost()) + " lost";
    return text + (sensors.detail().empty() ? "" : ": " + sensors.detail());
}

std::string inertial_text(const v1::InertialCalibration& inertial) {
    std::string text;
    if (const auto& at = inertial.pose().translation_mm(); at.size() == 3) {
        text = fixed(std::hypot(at[0], at[1], at[2]), 1) + " mm from the left camera";
    } else {
        text = "place unknown";
    }
    text += inertial.has_time_offset() ? ", samples " + fixed(1000 * inertial.time_offset().seconds(), 3) + " ms later"
                                       : ", time offset unknown";
    return text + (inertial.gyroscope_noise_density() > 0 ? ", noise known" : ", noise unknown");
}

void print(const v1::Status& status) {
    print_row("state", status.state() + (status.detail().empty() ? "" : ": " + status.detail()));
    print_row("version", status.server_version());
    print_row("uptime", fixed(status.uptime_s(), 0) + " s");
    print_row("source", status.source());
    print_row("camera", status.has_camera() ? camera_text(status.camera()) : "");
    print_row("sensors", status.has_sensors() ? sensors_text(status.sensors()) : "");
    print_row("inertial", status.has_inertial_calibration() ? inertial_text(status.inertial_calibration()) : "");
    if (status.geometry().width() > 0) {  // else the first source is being prepared
        print_row("matching",
                  status.method() + " on " + status.backend() + ", " + base::counted(status.workers(), "worker"));
        print_row("geometry", geometry_text(status.geometry()));
        print_row("rate", fixed(status.rate(), 1) + " frames/s");
        print_row(
            "frames",
            std::to_string(status.captured()) + " captured, " + std::to_string(status.published()) + " published, " +
                std::to_string(status.dropped()) + " dropped, " + std::to_string(status.lost()) +
                " lost by the source, " + std::to_string(status.damaged()) + " damaged" +
                (status.unwanted() > 0 ? ", " + std::to_string(status.unwanted()) + " unwanted" : "") +
                (status.over_budget() > 0 ? ", " + std::to_string(status.over_budget()) + " over the budget" : ""));
    }
    for (const json::Fact& fact : json::facts_of(status)) {
        print_row(fact.title, fact.text);
    }
    print_row("recording", record_text(status.record()));
    if (status.has_self_calibration()) {
        print_row("self-calib.", self_calibration_text(status.self_calibration()));
    }
    for (const std::string& notice : status.notices()) {
        print_row("notice", notice);
    }
    if (status.steps_size() > 0) {
        Table steps({"step, ms", "count", "mean", "p50", "p90", "p99", "max"});
        for (const v1::StepTime& step : status.steps()) {
            steps.add({step.name(), std::to_string(step.count()), fixed(step.mean_us() / 1e3, 2),
                       fixed(step.p50_us() / 1e3, 2), fixed(step.p90_us() / 1e3, 2), fixed(step.p99_us() / 1e3, 2),
                       fixed(step.max_us() / 1e3, 2)});
        }
        std::cout << '\n';
        steps.print(std::cout);
    }
    if (status.clients_size() > 0) {
        Table clients({"client", "address", "sent", "skipped", "MB", "compressor"});
        for (const v1::ClientStatus& client : status.clients()) {
            clients.add({client.name(), client.address(), std::to_string(client.frames_sent()),
                         std::to_string(client.frames_skipped()),
                         fixed(static_cast<double>(client.bytes_sent()) / 1e6, 1),
                         client.compressed_bytes() > 0 ? fixed(client.compressor_share() * 100, 0) + " %" : "-"});
        }
        std::cout << '\n';
        clients.print(std::cout);
    }
}

int show_status(const StatusArguments& arguments) {
    disparity::Client client = connect(arguments.daemon);
    const v1::Status status = daemon_status(client.socket());
    if (arguments.json) {
        std::cout << to_text(to_json(status), 2) << '\n';
    } else {
        print(status);
    }
    return exit_done;
}

}  // namespace

void add_status(CLI::App& program, Action& action) {
    CLI::App& command =
        *program.add_subcommand("status", "Show what a running daemon does: state, rates, times, clients.");
    const auto arguments = std::make_shared<StatusArguments>();
    arguments->daemon.add_to(command);
    command.add_flag("--json", arguments->json, "one JSON object");
    command.footer(
        "Exit status 1 when no daemon answers.\n"
        "Example: disparityctl status --json | jq .rate");
    command.callback([arguments, &action] { action = [arguments] { return show_status(*arguments); }; });
}

}  // namespace disparityd::tools
