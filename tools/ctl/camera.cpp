// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include <CLI/CLI.hpp>

#include "capture/camera/camera_controls.h"
#include "tools/command_line/table.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/daemon.h"
#include "tools/ctl/describe.h"

namespace disparityd::tools {
namespace {

struct CameraArguments {
    DaemonArguments daemon;
    std::vector<std::string> settings;
    bool json = false;
};

void print(const v1::CameraControls& controls) {
    Table table({"control", "value", "min", "max", "default"});
    for (const v1::CameraControl& control : controls.controls()) {
        table.add({control.name(), std::to_string(control.value()), std::to_string(control.min()),
                   std::to_string(control.max()), std::to_string(control.default_())});
    }
    table.print(std::cout);
}

int camera(const CameraArguments& arguments) {
    std::string text;
    for (const std::string& setting : arguments.settings) {
        text += setting + ' ';
    }
    std::vector<std::pair<std::string, std::int64_t>> settings;
    for (const capture::CameraSetting& setting : capture::parse_camera_settings(text, "camera")) {
        settings.emplace_back(setting.name, setting.value);
    }
    disparity::Client client = connect(arguments.daemon);
    const v1::CameraControls controls = control_daemon_camera(client.socket(), settings);
    if (arguments.json) {
        std::cout << to_text(to_json(controls).at("controls"), 2) << '\n';
    } else {
        print(controls);
    }
    return exit_done;
}

}  // namespace

void add_camera(CLI::App& program, Action& action) {
    CLI::App& command = *program.add_subcommand(
        "camera",
        "Show the controls of a running daemon's camera, or set some of them: exposure, gain, white balance.");
    const auto arguments = std::make_shared<CameraArguments>();
    command.add_option("CONTROL", arguments->settings, "controls to set, in this order; none: only show them")
        ->type_name("NAME=VALUE");
    command.add_flag("--json", arguments->json, "a list of objects");
    arguments->daemon.add_to(command);
    command.footer(
        "A value holds until the daemon ends, also when the camera is plugged in again, or until a reload has another\n"
        "value for that control. [source] controls in the configuration makes it permanent. Nothing is set when one\n"
        "name or value is wrong.\n"
        "Exposure and gain of a ZED can be set for each eye once auto-exposure is 0.\n"
        "Examples: disparityctl camera\n"
        "          disparityctl camera auto-exposure=0 exposure-left=400 exposure-right=400");
    command.callback([arguments, &action] { action = [arguments] { return camera(*arguments); }; });
}

}  // namespace disparityd::tools
