// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "pipeline/calibrating_schedule.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/table.h"
#include "tools/ctl/calibration/rows_picture.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/output_file.h"
#include "tools/ctl/source_arguments.h"
#include "tools/images/image_file.h"

namespace disparityd::tools {
namespace {

constexpr int default_frames = 8;
constexpr int widest_disparity = 128;

struct RowsArguments {
    std::string source;
    std::string output;
    std::string calibration;
    std::optional<int> frames;
    std::optional<int> disparities;
    bool force = false;
};

int show_rows(const RowsArguments& arguments) {
    images::check_picture_name(arguments.output);
    check_output(arguments.output, arguments.force);
    capture::SourceOptions options;
    options.uri = arguments.source;
    options.loans = 2;
    options.pace = capture::Pace::fastest;
    options.calibration_path = arguments.calibration;
    const auto source = open_with_progress(options);
    const DisparityRange range{0, arguments.disparities.value_or(widest_disparity)};
    const int frames = arguments.frames.value_or(default_frames);
    pipeline::CalibratingSchedule schedule(source->info(), {}, range, {1, frames});
    catch_interrupts();
    std::optional<capture::RawFrame> last;
    std::shared_ptr<const calibration::Rectification> found;
    for (int i = 0; i < frames; ++i) {
        auto frame = next_frame(*source);
        if (!frame) {
            break;
        }
        if (last) {
            source->give_back(*last);
        }
        last = frame;
        found = schedule.for_frame(*last);
    }
    if (!last && interrupted()) {
        print_note("stopped by " + interrupted_by() + " before the first frame; nothing was written");
        return exit_interrupted;
    }
    if (!last) {
        throw std::runtime_error(arguments.source + ": there is no frame in it");
    }
    const RowsOfPair before(last->image, schedule.factory(), range);
    const RowsOfPair after(last->image, *found, range);
    source->give_back(*last);
    images::write_picture(arguments.output, rows_picture(before, after));
    std::cout << arguments.output << ": median |left y - right y| of the corners of the last frame "
              << fixed(before.rows().median, 2) << " px as calibrated, " << fixed(after.rows().median, 2)
              << " px self-calibrated; wrong matches, which are left out: " << fixed(100 * before.rows().wrong, 0)
              << " % and " << fixed(100 * after.rows().wrong, 0) << " %\n";
    for (const auto& [sequence, result] : schedule.estimates()) {
        std::cout << "frame " << sequence << ": " << (result.accepted ? "corrected" : "nothing changed") << ": "
                  << result.reason << '\n';
    }
    return exit_done;
}

}  // namespace

void add_rows(CLI::App& program, Action& action) {
    CLI::App& command = *program.add_subcommand(
        "rows", "Picture of how well the rows of a rectified pair agree, before and after self-calibration.");
    const auto arguments = std::make_shared<RowsArguments>();
    command
        .add_option("SOURCE", arguments->source, "raw pairs of cameras with a calibration; see disparityctl sources")
        ->required();
    command.add_option("-o,--output", arguments->output, "picture to write (.png, .jpg)")
        ->type_name("FILE")
        ->required();
    command.add_option("--calibration", arguments->calibration, "calibration instead of the source's own")
        ->type_name("FILE");
    add_integer(command, "--frames", arguments->frames, 1, 1000,
                "frames to look at; default " + std::to_string(default_frames));
    add_integer(command, "--disparities", arguments->disparities, 16, 256,
                "range of disparities in which corners are searched; default " + std::to_string(widest_disparity));
    command.add_flag("--force", arguments->force, "replace the file");
    command.footer(
        "The picture shows six places of the image, magnified six times, left eye beside right eye: on the left as\n"
        "the calibration rectifies them, on the right after self-calibration. A line marks the row of the left eye's\n"
        "corner, a cross the corner in the right eye: it lies on the line where the rows agree. Corners whose row\n"
        "offset differs by more than half a pixel from that of their surroundings are wrong matches: they are left\n"
        "out and counted.\n"
        "Example: disparityctl rows drive.mkv -o rows.png");
    command.callback([arguments, &action] { action = [arguments] { return show_rows(*arguments); }; });
}

}  // namespace disparityd::tools
