// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/message_text.h"
#include "base/words.h"
#include "calibration/board/board.h"
#include "calibration/formats/calibration_formats.h"
#include "capture/images/image_sequence.h"
#include "kernels/raw_image.h"
#include "kernels/reference/steps.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/table.h"
#include "tools/ctl/calibration/board_arguments.h"
#include "tools/ctl/calibration/calibration_report.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/output_file.h"
#include "tools/ctl/source_arguments.h"
#include "tools/images/image_file.h"

namespace disparityd::tools {
namespace {

/// Owns the luma of both eyes of a raw frame, not rectified.
class LumaPair {
public:
    explicit LumaPair(const RawImage& raw);

    Plane<const std::uint8_t> left() const { return {left_.data(), width_, height_, width_}; }
    Plane<const std::uint8_t> right() const { return {right_.data(), width_, height_, width_}; }

private:
    int width_;
    int height_;
    std::vector<std::uint8_t> left_;
    std::vector<std::uint8_t> right_;
};

LumaPair::LumaPair(const RawImage& raw)
    : width_(raw.eye_width),
      height_(raw.height),
      left_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)),
      right_(left_.size()) {
    const Rectifier as_it_is;
    reference::rectify(raw, Eye::left, as_it_is, {left_.data(), width_, height_, width_}, {0, height_});
    reference::rectify(raw, Eye::right, as_it_is, {right_.data(), width_, height_, width_}, {0, height_});
}

constexpr int default_views = 20;

// The board must move by this part of the image's width to be another view.
constexpr double least_way = 0.02;

struct CalibrateArguments {
    std::string source;
    std::string output;
    std::string report;
    BoardArguments board;
    std::string model = "brown";
    std::optional<int> views;
    std::optional<int> every;
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

/// Names a frame: by its files where the source consists of images, else by its number.
class FileNames {
public:
    explicit FileNames(const std::string& source) {
        if (capture::is_image_sequence(source)) {
            images_ = capture::find_images(capture::parse_image_uri(source).path).frames;
        }
    }

    std::string of(const capture::RawFrame& frame) const {
        if (frame.sequence >= images_.size()) {
            return "frame " + std::to_string(frame.sequence);
        }
        const auto& files = images_[frame.sequence];
        const std::string left = file_name(files.left);
        const std::string right = file_name(files.right);
        return right.empty() || right == left ? left : left + ", " + right;
    }

private:
    static std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

    std::vector<capture::ImageSequence::Frame> images_;
};

/// Collects views of a source and guides the person who holds the board.
class Collector {
public:
    Collector(const CalibrateArguments& arguments, const capture::SourceInfo& info)
        : arguments_(arguments), board_(board_of(arguments.board)), info_(info), files_(arguments.source) {}

    bool enough() const { return views_.size() >= static_cast<std::size_t>(wanted()); }

    void look_at(const capture::RawFrame& frame) {
        if (frame_number_++ % static_cast<std::uint64_t>(arguments_.every.value_or(1)) != 0) {
            return;
        }
        const LumaPair eyes(frame.image);
        const auto view = calibration::find_board(eyes.left(), eyes.right(), board_);
        if (!view) {
            say(frame,
                board_.markers ? "both eyes see too little of the board" : "the board is not seen whole by both eyes");
            return;
        }
        if (!views_.empty() && calibration::moved(views_.back(), *view) < least_way * info_.eye_width) {
            say(frame, "the board has not moved");
            return;
        }
        views_.push_back(*view);
        pictures_.push_back(shrink(eyes.left(), eyes.right()));
        pictures_.back().frame = files_.of(frame);
        const auto missing = missing_views();
        say(frame, "view " + std::to_string(views_.size()) + " of " + std::to_string(wanted()) +
                       (missing.empty() ? "" : "; " + missing.front()));
    }

    std::vector<std::string> missing_views() const {
        return calibration::missing_views(views_, board_, info_.eye_width, info_.height);
    }
    const std::vector<calibration::BoardView>& views() const { return views_; }
    const std::vector<ViewPicture>& pictures() const { return pictures_; }
    const calibration::Board& board() const { return board_; }

private:
    int wanted() const { return arguments_.views.value_or(default_views); }

    /// Prints a line of guidance, unless it is the same as the line before.
    void say(const capture::RawFrame& frame, const std::string& text) {
        if (text != said_) {
            std::cerr << files_.of(frame) << ": " << text << '\n';
            said_ = text;
        }
    }

    const CalibrateArguments& arguments_;
    const calibration::Board board_;
    const capture::SourceInfo& info_;
    const FileNames files_;
    std::uint64_t frame_number_ = 0;
    std::string said_;
    std::vector<calibration::BoardView> views_;
    std::vector<ViewPicture> pictures_;
};

void collect(capture::FrameSource& source, Collector& collector) {
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

void report(const CalibrateArguments& arguments, const calibration::BoardCalibration& found,
            const Collector& collector) {
    const std::vector<std::string> missing = collector.missing_views();
    const calibration::Coverage covered =
        calibration::covered_parts(collector.views(), found.calibration.width, found.calibration.height);
    if (arguments.json) {
        Json views = Json::array();
        for (std::size_t i = 0; i < found.views.size(); ++i) {
            const auto& view = found.views[i];
            views.push_back({{"frame", collector.pictures()[i].frame},
                             {"left_rms_px", view.left_rms},
                             {"right_rms_px", view.right_rms},
                             {"rows_px", view.rows}});
        }
        std::cout << to_text(Json{{"file", arguments.output},
                                  {"rms_px", found.rms},
                                  {"views", views},
                                  {"parts_seen", std::count(covered.begin(), covered.end(), true)},
                                  {"parts", covered.size()},
                                  {"missing", missing},
                                  {"calibration", to_json(found.calibration)}},
                             2)
                  << '\n';
        return;
    }
    Table table({"view", "frame", "left px", "right px", "rows px"});
    for (std::size_t i = 0; i < found.views.size(); ++i) {
        const auto& view = found.views[i];
        table.add({std::to_string(i + 1), collector.pictures()[i].frame, fixed(view.left_rms, 3),
                   fixed(view.right_rms, 3), fixed(view.rows, 3)});
    }
    table.print(std::cout);
    std::cout << arguments.output << ": RMS " << fixed(found.rms, 3) << " px over " << found.views.size()
              << " views, baseline " << fixed(-found.calibration.translation[0], 2) << " mm\n"
              << coverage_verdict(covered) << '\n';
    for (const std::string& line : missing) {
        print_note("it would be better to " + line);
    }
    const double baseline = -found.calibration.translation[0];
    constexpr double shortest = 20, longest = 2000;
    if (baseline < shortest || baseline > longest) {
        print_note("a baseline of " + fixed(baseline, 2) +
                   " mm is unusual: measure it; if it is wrong, --square was not the side of a square in mm, and all "
                   "distances are wrong by the same factor");
    }
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
    board_of(arguments.board);
    const calibration::BoardLens lens = lens_of(arguments);
    capture::SourceOptions options;
    options.uri = arguments.source;
    options.loans = 2;
    options.calibrated = false;
    options.pace = capture::Pace::fastest;
    const auto source = open_with_progress(options);
    const capture::SourceInfo& info = source->info();
    Collector collector(arguments, info);
    collect(*source, collector);
    constexpr std::size_t least_views = 3;
    if (interrupted() && collector.views().size() < least_views) {
        print_note("stopped by " + interrupted_by() + " with " + base::counted(collector.views().size(), "view") +
                   ", at least 3 are needed; nothing was written");
        return exit_interrupted;
    }
    const calibration::BoardCalibration found =
        calibration::calibrate(collector.views(), collector.board(), info.eye_width, info.height, lens);
    check_result(arguments, found.calibration);
    const std::string text = to_opencv_yaml(found.calibration);
    images::write_file(arguments.output, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    if (!arguments.report.empty()) {
        images::write_picture(arguments.report, report_picture(collector.pictures(), collector.views(), found,
                                                               collector.missing_views()));
    }
    report(arguments, found, collector);
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
    command.add_flag("--force", arguments->force, "replace the files");
    command.add_flag("--json", arguments->json, "the result as one JSON object");
    command.footer(
        "While it runs, standard error says what the board should do next. Ctrl-C: calibrate with the views so far.\n"
        "A board of 10 x 7 squares has 9 x 6 inner corners. Both eyes must see a whole chessboard, or a part of\n"
        "a ChArUco board. An RMS below 0.5 px is good; a view with far more than the others is blurred or misread.\n"
        "Example: disparityctl calibrate 'left%02d.jpg,right%02d.jpg' --square 25 -o my.yml --report my.png");
    command.callback([arguments, &action] { action = [arguments] { return run_calibration(*arguments); }; });
}

}  // namespace disparityd::tools
