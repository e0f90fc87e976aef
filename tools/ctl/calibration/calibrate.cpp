// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <regex>
#include <stdexcept>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/message_text.h"
#include "base/words.h"
#include "calibration/board/board.h"
#include "calibration/board/verdict.h"
#include "calibration/formats/calibration_formats.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/table.h"
#include "tools/ctl/calibration/board_arguments.h"
#include "tools/ctl/calibration/calibration_report.h"
#include "tools/ctl/calibration/view_collector.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/output_file.h"
#include "tools/ctl/source_arguments.h"
#include "tools/images/image_file.h"

namespace disparityd::tools {
namespace {

constexpr int default_views = 20;

struct CalibrateArguments {
    std::string source;
    std::string output;
    std::string report;
    BoardArguments board;
    std::string model = "brown";
    std::optional<int> views;
    std::optional<int> every;
    std::vector<std::string> also;
    bool all_views = false;
    bool force = false;
    bool json = false;
};

calibration::BoardLens lens_of(const CalibrateArguments& arguments) {
    for (const auto& [name, lens] : {std::pair("brown", calibration::BoardLens::brown),
                                     {"rational", calibration::BoardLens::rational},
                                     {"fisheye", calibration::BoardLens::fisheye}}) {
        if (arguments.model == name) {
            return lens;
        }
    }
    throw std::invalid_argument("--model: found '" + base::printable(arguments.model) +
                                "', allowed: brown, rational or fisheye");
}

void collect(capture::FrameSource& source, ViewCollector& collector) {
    catch_interrupts();
    while (!collector.enough()) {
        const auto frame = next_frame(source);
        if (!frame) {
            return;
        }
        try {
            collector.look_at(*frame);
        } catch (...) {
            source.give_back(*frame);
            throw;
        }
        source.give_back(*frame);
    }
}

Json coverage_json(const calibration::EyeCoverage& coverage) {
    return {{"covered_ratio", coverage.ratio},
            {"parts_seen", std::count(coverage.parts.begin(), coverage.parts.end(), true)},
            {"parts", coverage.parts.size()}};
}

Json view_json(const std::string& frame, const calibration::BoardCalibration::View& view) {
    return {{"frame", frame}, {"left_rms_px", view.left_rms}, {"right_rms_px", view.right_rms}, {"rows_px", view.rows}};
}

void report_json(const CalibrateArguments& arguments, const calibration::CheckedCalibration& checked,
                 const ViewCollector& collector) {
    Json views = Json::array();
    for (std::size_t i = 0; i < checked.used.size(); ++i) {
        views.push_back(view_json(collector.pictures()[checked.used[i]].frame, checked.found.views[i]));
    }
    Json left_out = Json::array();
    for (const auto& [view, errors] : checked.left_out) {
        left_out.push_back(view_json(collector.pictures()[view].frame, errors));
    }
    std::cout << to_text(Json{{"file", arguments.output},
                              {"verdict", to_string(checked.judgement.verdict)},
                              {"reasons", checked.judgement.reasons},
                              {"rms_px", checked.found.rms},
                              {"views", views},
                              {"left_out", left_out},
                              {"left", coverage_json(checked.judgement.coverage.left)},
                              {"right", coverage_json(checked.judgement.coverage.right)},
                              {"missing", checked.judgement.missing},
                              {"calibration", to_json(checked.found.calibration)}},
                         2)
              << '\n';
}

void report_text(const CalibrateArguments& arguments, const calibration::CheckedCalibration& checked,
                 const ViewCollector& collector) {
    Table table({"view", "frame", "left px", "right px", "rows px", ""});
    const auto add = [&](std::size_t view, const calibration::BoardCalibration::View& errors, const char* note) {
        table.add({std::to_string(view + 1), collector.pictures()[view].frame, fixed(errors.left_rms, 3),
                   fixed(errors.right_rms, 3), fixed(errors.rows, 3), note});
    };
    for (std::size_t i = 0; i < checked.used.size(); ++i) {
        add(checked.used[i], checked.found.views[i], "");
    }
    for (const auto& [view, errors] : checked.left_out) {
        add(view, errors, "left out");
    }
    table.print(std::cout);
    const double baseline = -checked.found.calibration.translation[0];
    std::cout << arguments.output << ": RMS " << fixed(checked.found.rms, 3) << " px over " << checked.views.size()
              << " views, baseline " << fixed(baseline, 2) << " mm\n"
              << coverage_line(checked.judgement.coverage) << "\nverdict: " << to_string(checked.judgement.verdict)
              << '\n';
    for (const std::string& reason : checked.judgement.reasons) {
        std::cout << "- " << reason << '\n';
    }
    if (!checked.left_out.empty()) {
        print_note(base::counted(checked.left_out.size(), "view") +
                   " left out, as the corners do not fit those of the others: blurred, misread, a bent board, or one "
                   "that moved between the eyes' exposures; --all-views uses all");
    }
    for (const std::string& line : checked.judgement.missing) {
        print_note("it would be better to " + line);
    }
    constexpr double shortest = 20, longest = 2000;
    if (baseline < shortest || baseline > longest) {
        print_note("a baseline of " + fixed(baseline, 2) +
                   " mm is unusual: measure it; if it is wrong, --square was not the side of a square in mm, and all "
                   "distances are wrong by the same factor");
    }
}

/// Another mode of the camera, and the file of its calibration: that of 640x360 for my.yml is my-640x360.yml.
struct OtherMode {
    std::string file;
    int width = 0;
    int height = 0;
};

/// Throws std::invalid_argument for a --also that is no size.
std::vector<OtherMode> other_modes(const CalibrateArguments& arguments) {
    std::vector<OtherMode> modes;
    for (const std::string& size : arguments.also) {
        static const std::regex two_numbers("([1-9][0-9]{0,3})x([1-9][0-9]{0,3})");
        std::smatch numbers;
        if (!std::regex_match(size, numbers, two_numbers)) {
            throw std::invalid_argument("--also: found '" + base::printable(size) +
                                        "', allowed: the size of one eye in another mode, as 640x360");
        }
        const std::filesystem::path output(arguments.output);
        const std::string name = output.stem().string() + "-" + size + output.extension().string();
        modes.push_back({(output.parent_path() / name).string(), std::stoi(numbers[1]), std::stoi(numbers[2])});
    }
    return modes;
}

void write_calibration(const std::string& file, const calibration::StereoCalibration& calibration) {
    images::write_file(file, to_opencv_yaml(calibration));
}

/// Refuses a calibration that the daemon would refuse, before a file is written.
void check_result(const CalibrateArguments& arguments, const calibration::StereoCalibration& calibration) {
    if (calibration.translation[0] >= 0) {
        throw std::invalid_argument(arguments.source +
                                    ": the right camera lies left of the left one: exchange the two eyes of the "
                                    "source; no file was written");
    }
    try {
        check_plausible(calibration, arguments.source);
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(std::string(error.what()) +
                                    "; no file was written: take sharper views, from more sides");
    }
}

int run_calibration(const CalibrateArguments& arguments) {
    images::check_ending(arguments.output, {".yml", ".yaml"});
    check_output(arguments.output, arguments.force);
    if (!arguments.report.empty()) {
        images::check_picture_name(arguments.report);
        check_output(arguments.report, arguments.force);
    }
    const calibration::Board board = board_of(arguments.board);
    const std::vector<OtherMode> modes = other_modes(arguments);
    for (const OtherMode& mode : modes) {
        check_output(mode.file, arguments.force);
    }
    const calibration::BoardLens lens = lens_of(arguments);
    capture::SourceOptions options;
    options.uri = arguments.source;
    options.loans = 2;
    options.calibrated = false;
    options.pace = capture::Pace::fastest;
    const auto source = open_with_progress(options);
    const capture::SourceInfo& info = source->info();
    calibration::StereoCalibration only_size;
    only_size.width = info.eye_width;
    only_size.height = info.height;
    for (const OtherMode& mode : modes) {
        scaled(only_size, mode.width, mode.height);  // refused before the board is shown
    }
    ViewCollector collector(arguments.source, board, info, arguments.views.value_or(default_views),
                            arguments.every.value_or(1));
    collect(*source, collector);
    constexpr std::size_t least_views = 3;
    if (interrupted() && collector.views().size() < least_views) {
        print_note("stopped by " + interrupted_by() + " with " + base::counted(collector.views().size(), "view") +
                   ", at least 3 are needed; nothing was written");
        return exit_interrupted;
    }
    if (const std::string other = collector.other_board(); !other.empty()) {
        if (collector.views().empty()) {
            throw std::invalid_argument(arguments.source + ": " + other);
        }
        print_note(other);
    }
    const calibration::CheckedCalibration checked = calibration::calibrate_and_judge(
        collector.views(), board, info.eye_width, info.height, lens, arguments.all_views);
    check_result(arguments, checked.found.calibration);
    write_calibration(arguments.output, checked.found.calibration);
    for (const OtherMode& mode : modes) {
        write_calibration(mode.file, scaled(checked.found.calibration, mode.width, mode.height));
    }
    if (!arguments.report.empty()) {
        images::write_picture(arguments.report, report_picture(collector.pictures(), collector.views(), checked));
    }
    (arguments.json ? report_json : report_text)(arguments, checked, collector);
    for (const OtherMode& mode : modes) {
        print_note(mode.file +
                   ": holds where that mode shows the same field of view; disparityctl rows shows whether "
                   "it does");
    }
    return exit_done;
}

}  // namespace

void add_calibrate(CLI::App& program, Action& action) {
    CLI::App& command = *program.add_subcommand(
        "calibrate", "Calibrate a stereo camera with a chessboard or ChArUco board, from images or live, into a file.");
    const auto arguments = std::make_shared<CalibrateArguments>();
    command
        .add_option(
            "SOURCE", arguments->source,
            "raw pairs that show the board: a camera, a folder, a pattern, a recording; see disparityctl sources")
        ->required();
    command.add_option("-o,--output", arguments->output, "calibration file to write (OpenCV YAML)")
        ->type_name("FILE")
        ->required();
    command.add_option("--square", arguments->board.square_mm, "side of a square in mm, as measured")
        ->type_name("MM")
        ->required();
    add_board_options(command, arguments->board);
    command
        .add_option("--model", arguments->model,
                    "lens: brown, rational (8 coefficients) or fisheye (equidistant, 4); default brown")
        ->type_name("NAME");
    command.add_option("--report", arguments->report, "picture of every view with its corners and errors (.png, .jpg)")
        ->type_name("FILE");
    add_integer(command, "--views", arguments->views, 3, 1000,
                "stop after this many; default " + std::to_string(default_views));
    add_integer(command, "--every", arguments->every, 1, 1000, "look at every Nth frame; default 1");
    command
        .add_option(
            "--also", arguments->also,
            "size of one eye in another mode of the camera with the same field of view: write that calibration,\n"
            "scaled, to OUTPUT-WxH; may be given several times")
        ->type_name("WxH");
    command.add_flag("--all-views", arguments->all_views,
                     "use also views whose corners do not fit those of the others");
    command.add_flag("--force", arguments->force, "replace the files");
    command.add_flag("--json", arguments->json, "the result as one JSON object");
    command.footer(
        "While it runs, standard error says what the board should do next. Ctrl-C: calibrate with the views so far.\n"
        "A board of 10 x 7 squares has 9 x 6 inner corners. Both eyes must see a whole chessboard, or a part of\n"
        "a ChArUco board. Views with far more error than the others are left out. The verdict is good, usable or "
        "repeat.\n"
        "Example: disparityctl calibrate 'left%02d.jpg,right%02d.jpg' --square 25 -o my.yml --report my.png");
    command.callback([arguments, &action] { action = [arguments] { return run_calibration(*arguments); }; });
}

}  // namespace disparityd::tools
