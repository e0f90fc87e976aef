// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include <CLI/CLI.hpp>

#include "base/message_text.h"
#include "calibration/calibration_lookup.h"
#include "capture/camera/camera_format.h"
#include "capture/camera/camera_identity.h"
#include "capture/camera/camera_problem.h"
#include "capture/camera/camera_survey.h"
#include "capture/camera/stereo_advice.h"
#include "tools/command_line/table.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/source_arguments.h"

namespace disparityd::tools {
namespace {

struct SourcesArguments {
    std::string uri;
    std::string calibration;
    bool json = false;
};

/// Returns lines such as "YUYV 2560x720 at 60, 30, 15 frames/s".
std::vector<std::string> mode_lines(const capture::CameraSurvey& survey) {
    std::vector<std::string> lines;
    for (const capture::VideoMode& mode : survey.modes) {
        const bool read = capture::camera_format_of_fourcc(capture::fourcc_of(mode.format)) != nullptr;
        std::string line = mode.format + " " + std::to_string(mode.width) + "x" + std::to_string(mode.height);
        for (std::size_t i = 0; i < mode.rates.size(); ++i) {
            line += (i == 0 ? " at " : ", ") + fixed(mode.rates[i], 0);
        }
        lines.push_back(line + (mode.rates.empty() ? "" : " frames/s") + (read ? "" : " (this format is not read)"));
    }
    return lines;
}

/// Whether one of the folders of the default configuration has the camera's calibration.
bool has_calibration(const std::string& serial, const capture::StereoAdvice& advice) {
    const auto folders = calibration::folder_list(calibration::standard_calibration_folders);
    try {
        return calibration::find_camera_calibration(serial, folders, advice.eye_width, advice.eye_height).has_value();
    } catch (const std::invalid_argument& error) {
        print_note(error.what());
        return false;
    }
}

/// Says how to start with what looks like a stereo pair, and how it gets a calibration where it has none.
void print_advice(const std::string& serial, const capture::StereoAdvice& advice) {
    const std::string uri = "'" + base::printable(advice.uri, advice.uri.size()) + "'";
    if (has_calibration(serial, advice)) {
        std::cout << "    start with: disparityd --source " << uri << '\n';
        return;
    }
    std::cout << "    it has no calibration yet: disparityctl board -o board.pdf, print that, then\n"
              << "      disparityctl calibrate " << uri << " --square 25 -o my.yml\n"
              << "    start with: disparityd --source " << uri << " --set source.calibration=my.yml\n"
              << "      without calibration there are no distances: --set source.allow_unrectified=true\n";
}

void print_cameras(const std::vector<capture::CameraSurvey>& cameras) {
    std::cout << '\n' << (cameras.empty() ? "no cameras" : "cameras") << '\n';
    for (const capture::CameraSurvey& survey : cameras) {
        const capture::UsbCamera& camera = survey.camera;
        const std::string label = camera.label();
        std::cout << "  " << base::printable(label, label.size());
        if (camera.speed_mbit > 0) {
            std::cout << ", USB " << fixed(camera.speed_mbit, 0) << " Mbit/s, firmware "
                      << capture::firmware_text(camera.firmware);
        }
        std::cout << '\n';
        if (!survey.problem.empty()) {
            std::cout << "    cannot be used: " << survey.problem << '\n';
        }
        for (const std::string& notice : survey.notices) {
            std::cout << "    notice: " << notice << '\n';
        }
        for (const std::string& line : mode_lines(survey)) {
            std::cout << "    " << line << '\n';
        }
        if (const auto advice = capture::advise(survey)) {
            std::cout << "    looks like a stereo camera: " << advice->reason << '\n';
            print_advice(camera.serial, *advice);
        } else if (survey.problem.empty()) {
            std::cout << "    does not look like a stereo camera: no mode is two usual pictures side by side\n";
        }
    }
}

void print_pairs(const std::vector<capture::CameraSurvey>& cameras) {
    for (const capture::PairAdvice& pair : capture::advise_pairs(cameras)) {
        const capture::UsbCamera& left = cameras[pair.left].camera;
        const capture::UsbCamera& right = cameras[pair.right].camera;
        const std::string names = left.label() + " and " + right.label();
        std::cout
            << "  " << base::printable(names, names.size()) << '\n'
            << "    look like the two eyes of a stereo camera: " << pair.advice.reason << '\n'
            << "    which is the left one cannot be told: cover it and look, exchange left= and right= if need be\n";
        print_advice(capture::pair_serial(left.serial, right.serial), pair.advice);
    }
}

void list_kinds(bool json) {
    Json list = Json::array();
    const auto cameras = capture::survey_cameras(capture::linux_video_system());
    for (const capture::SourceKind& kind : capture::source_kinds()) {
        if (json) {
            list.push_back({{"name", kind.name}, {"description", kind.description}});
            if (kind.name == "v4l2") {
                list.back()["cameras"] = Json::array();
                for (const capture::CameraSurvey& survey : cameras) {
                    list.back()["cameras"].push_back(to_json(survey));
                }
                list.back()["pairs"] = Json::array();
                for (const capture::PairAdvice& pair : capture::advise_pairs(cameras)) {
                    list.back()["pairs"].push_back({{"left", cameras[pair.left].camera.node},
                                                    {"right", cameras[pair.right].camera.node},
                                                    {"reason", pair.advice.reason},
                                                    {"uri", pair.advice.uri}});
                }
            }
        } else {
            std::cout << kind.name << std::string(kind.name.size() < 12 ? 12 - kind.name.size() : 1, ' ')
                      << kind.description << '\n';
        }
    }
    if (json) {
        std::cout << to_text(list, 2) << '\n';
    } else {
        print_cameras(cameras);
        print_pairs(cameras);
    }
}

int sources(const SourcesArguments& arguments) {
    if (arguments.uri.empty()) {
        list_kinds(arguments.json);
        return exit_done;
    }
    capture::SourceOptions options;
    options.uri = arguments.uri;
    options.calibration_path = arguments.calibration;
    const auto source = open_with_progress(options);
    const capture::SourceInfo& info = source->info();
    if (arguments.json) {
        std::cout << to_text(to_json(info), 2) << '\n';
    } else {
        std::cout << base::printable(info.description, info.description.size()) << '\n' << summary(info) << '\n';
    }
    return exit_done;
}

}  // namespace

void add_sources(CLI::App& program, Action& action) {
    CLI::App& command = *program.add_subcommand(
        "sources", "List the kinds of sources and the cameras, or open one source and describe it.");
    const auto arguments = std::make_shared<SourcesArguments>();
    command.add_option("URI", arguments->uri, "a source to open and describe");
    command.add_option("--calibration", arguments->calibration, "calibration instead of the source's own")
        ->type_name("FILE");
    command.add_flag("--json", arguments->json, "a list of objects, cameras in that of v4l2; with a URI one object");
    command.footer(
        "Examples: disparityctl sources\n"
        "          disparityctl sources scene:hd720@30");
    command.callback([arguments, &action] { action = [arguments] { return sources(*arguments); }; });
}

}  // namespace disparityd::tools
