// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <iostream>
#include <span>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "calibration/calibrating_schedule.h"
#include "capture/rectification_schedule.h"
#include "pipeline/pipeline.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/interrupt.h"
#include "tools/ctl/limited_source.h"
#include "tools/ctl/match_arguments.h"
#include "tools/ctl/number_argument.h"
#include "tools/ctl/process_output.h"
#include "tools/ctl/progress.h"
#include "tools/ctl/source_arguments.h"
#include "tools/ctl/table.h"
#include "tools/images/disparity_file.h"

namespace disparityd::tools {
namespace {

constexpr int default_disparities = 64;

struct ProcessArguments {
    std::string source;
    std::string folder;
    std::string method = "sgm";
    std::string backend = "auto";
    std::string calibration;
    std::string size;
    std::string region;
    MatchArguments match;
    std::optional<int> workers;
    std::optional<int> frames;
    bool self_calibrate = false;
    bool no_self_calibration = false;
    bool pfm = false;
    bool colour = false;
    bool force = false;
    bool json = false;
};

/// Whole numbers between separators, the last two a width and a height; throws std::invalid_argument unless there are
/// as many as wanted.
void parse_numbers(const std::string& option, const std::string& text, char separator, const char* form,
                   std::span<int* const> numbers) {
    const char* at = text.data();
    const char* const end = text.data() + text.size();
    bool good = true;
    for (std::size_t i = 0; i < numbers.size() && good; ++i) {
        const auto [stop, error] = std::from_chars(at, end, *numbers[i]);
        good = error == std::errc() && (i + 1 == numbers.size() ? stop == end : stop != end && *stop == separator);
        at = stop + 1;
    }
    good = good && std::all_of(numbers.end() - 2, numbers.end(), [](const int* side) { return *side >= 1; });
    if (!good) {
        throw std::invalid_argument(option + ": found '" + text + "', allowed: " + form);
    }
}

capture::RectifiedGeometry geometry_of(const ProcessArguments& arguments) {
    capture::RectifiedGeometry geometry;
    if (!arguments.size.empty()) {
        int* const numbers[] = {&geometry.width, &geometry.height};
        parse_numbers("--size", arguments.size, 'x', "WIDTHxHEIGHT such as 640x360", numbers);
    }
    if (!arguments.region.empty()) {
        auto& region = geometry.region;
        int* const numbers[] = {&region.x, &region.y, &region.width, &region.height};
        parse_numbers("--region", arguments.region, ',', "X,Y,WIDTH,HEIGHT such as 0,100,640,160", numbers);
    }
    return geometry;
}

std::unique_ptr<capture::FrameSource> open(const ProcessArguments& arguments, int loans) {
    capture::SourceOptions options;
    options.uri = arguments.source;
    options.loans = loans;
    options.pace = capture::Pace::fastest;
    options.calibration_path = arguments.calibration;
    auto source = open_with_progress(options);
    if (arguments.frames) {
        return std::make_unique<LimitedSource>(std::move(source), static_cast<std::uint64_t>(*arguments.frames));
    }
    if (source->info().live && !source->info().frame_count) {
        print_note(arguments.source + " has no end: Ctrl-C stops, or use --frames");
    }
    return source;
}

OutputFormats formats_of(const ProcessArguments& arguments, DisparityRange range) {
    OutputFormats formats{true, arguments.pfm, arguments.colour};
    if (!images::fits_png(range)) {
        formats.png = false;
        formats.pfm = true;
        print_note("disparities " + std::to_string(range.first) + " .. " +
                   std::to_string(range.first + range.count - 1) +
                   " do not fit a 16-bit PNG of disparity x 256: writing PFM instead");
    }
    return formats;
}

/// Runs the pipeline to its end, or to the end of the frames in flight after Ctrl-C.
void run(pipeline::Pipeline& pipeline, const std::optional<std::uint64_t>& total) {
    catch_interrupts();
    Progress bar("frames", total);
    pipeline.start();
    while (!pipeline.wait_until_ended(std::chrono::milliseconds(50)) && !interrupted()) {
        const pipeline::PipelineStatus now = pipeline.status();
        bar.show(now.published, fixed(now.rate, 1) + " frames/s");
    }
    pipeline.stop();
}

/// What each frame is rectified with: what --self-calibrate finds, what the recording says, or the calibration alone.
struct Schedule {
    std::unique_ptr<capture::RectificationSchedule> frames;
    const calibration::CalibratingSchedule* calibrating = nullptr;  ///< the same where it estimates
};

Schedule schedule_of(const ProcessArguments& arguments, const capture::SourceInfo& info, DisparityRange range) {
    const capture::RectifiedGeometry geometry = geometry_of(arguments);
    if (arguments.self_calibrate) {
        auto estimating = std::make_unique<calibration::CalibratingSchedule>(info, geometry, range,
                                                                             calibration::CalibratingSchedule::Plan{});
        const calibration::CalibratingSchedule* calibrating = estimating.get();
        return {std::move(estimating), calibrating};
    }
    const auto follow = arguments.no_self_calibration ? capture::RectificationBook::Follow::applied
                                                      : capture::RectificationBook::Follow::recorded;
    return {std::make_unique<capture::RectificationBook>(info, geometry, follow), nullptr};
}

Json schedule_json(const calibration::CalibratingSchedule& calibrating) {
    Json estimates = Json::array();
    for (const auto& [sequence, result] : calibrating.estimates()) {
        const capture::CalibrationCorrection& correction = result.correction;
        estimates.push_back({{"sequence", sequence},
                             {"accepted", result.accepted},
                             {"reason", result.reason},
                             {"frames", result.frames},
                             {"matches", result.matches},
                             {"vertical_error_before_px", result.error_before},
                             {"vertical_error_after_px", result.accepted ? Json(result.error_after) : Json()},
                             {"pitch_nrad", correction.pitch_nrad},
                             {"yaw_nrad", correction.yaw_nrad},
                             {"roll_nrad", correction.roll_nrad},
                             {"focal_ppb", correction.focal_ppb}});
    }
    return estimates;
}

void report_estimates(const calibration::CalibratingSchedule& calibrating) {
    for (const auto& [sequence, result] : calibrating.estimates()) {
        std::cout << "self-calibration, frame " << sequence << ": "
                  << (result.accepted ? "corrected" : "nothing changed") << ": " << result.reason << '\n';
    }
}

int report(const ProcessArguments& arguments, const pipeline::PipelineStatus& status,
           const calibration::CalibratingSchedule* calibrating, std::uint64_t frames, double seconds) {
    const double rate = seconds > 0 ? static_cast<double>(frames) / seconds : 0;
    if (arguments.json) {
        Json json{{"folder", arguments.folder},
                  {"frames", frames},
                  {"damaged_frames_skipped", status.skipped_corrupt},
                  {"seconds", seconds},
                  {"frames_per_second", rate},
                  {"complete", status.error.empty() && !interrupted()},
                  {"error", status.error}};
        if (calibrating != nullptr) {
            json["self_calibration"] = schedule_json(*calibrating);
        }
        std::cout << to_text(json, 2) << '\n';
    } else {
        if (calibrating != nullptr) {
            report_estimates(*calibrating);
        }
        std::cout << arguments.folder << ": " << frames << " frames in " << fixed(seconds, 1) << " s, "
                  << fixed(rate, 1) << " frames/s\n";
    }
    if (status.skipped_corrupt > 0) {
        print_note(std::to_string(status.skipped_corrupt) + " frames are marked as damaged and were left out");
    }
    if (!status.error.empty()) {
        print_error(status.error + "; the " + std::to_string(frames) + " frames before that are in " +
                    arguments.folder);
        return exit_failed;
    }
    if (interrupted()) {
        print_error("stopped by Ctrl-C; the " + std::to_string(frames) + " frames before that are in " +
                    arguments.folder);
        return exit_interrupted;
    }
    if (frames == 0) {
        print_error(arguments.source + ": there is no frame in it");
        return exit_failed;
    }
    return exit_done;
}

int process(const ProcessArguments& arguments) {
    ProcessOutput::check(arguments.folder, arguments.force);
    const MatchOptions options = arguments.match.options(parse_method(arguments.method), default_disparities);
    const Backend& chosen = backend(arguments.backend);
    pipeline::PipelineConfig config;
    config.policy = pipeline::Policy::replay;
    config.depth = false;

    const auto source = open(arguments, config.slots + 2);
    const capture::SourceInfo& info = source->info();
    config.left_colour = arguments.colour && info.format != PixelFormat::grey8;
    const Schedule schedule = schedule_of(arguments, info, options.range);
    const capture::Rectification& rectification = schedule.frames->factory();
    if (rectification.unrectified) {
        print_note(arguments.source + ": no calibration is known, frames are matched as they are");
    }
    const auto matcher = make_matcher(arguments.backend, {rectification.width, rectification.height, options});
    const std::string substitute(matcher->substitute());
    pipeline::WorkerPool workers(arguments.workers.value_or(0));

    std::optional<ProcessOutput> output;
    pipeline::Pipeline pipeline(config, *source, *matcher, workers, *schedule.frames,
                                [&output](const pipeline::FrameSlot& slot) { output->write(slot); });
    output.emplace(arguments.folder, formats_of(arguments, options.range), info, options,
                   substitute.empty() ? std::string(chosen.name) : substitute, rectification, pipeline.steps());
    const auto start = std::chrono::steady_clock::now();
    run(pipeline, info.frame_count);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    output->close();
    if (const std::string trouble = matcher->trouble(); !trouble.empty()) {
        print_note(trouble);
    }
    return report(arguments, pipeline.status(), schedule.calibrating, output->frames(), elapsed.count());
}

}  // namespace

void add_process(CLI::App& program, Action& action) {
    CLI::App& command =
        *program.add_subcommand("process", "Match every frame of a source into a folder of files, offline.");
    const auto arguments = std::make_shared<ProcessArguments>();
    command
        .add_option("SOURCE", arguments->source,
                    "a recording, a folder, a pattern with %d, scene:...; see disparityctl sources")
        ->required();
    command.add_option("-o,--output", arguments->folder, "folder to fill; made when missing")
        ->type_name("DIR")
        ->required();
    command.add_option("--method", arguments->method, "sgm (best), census, sad; default sgm")->type_name("METHOD");
    command.add_option("--backend", arguments->backend, backend_help())->type_name("NAME");
    command.add_option("--calibration", arguments->calibration, "calibration instead of the source's own")
        ->type_name("FILE");
    command.add_option("--size", arguments->size, "size of the rectified image; default: that of the capture")
        ->type_name("WxH");
    command.add_option("--region", arguments->region, "the part of it to match; default: all")->type_name("X,Y,W,H");
    add_integer(command, "--frames", arguments->frames, 1, 1'000'000'000, "stop after this many frames");
    add_integer(command, "--workers", arguments->workers, 0, 256, "worker threads; default 0: one per core");
    CLI::Option& self_calibrate =
        *command.add_flag("--self-calibrate", arguments->self_calibrate,
                          "estimate from the frames how the cameras have turned, four times in every 80 frames");
    command
        .add_flag("--no-self-calibration", arguments->no_self_calibration,
                  "leave out the corrections that a recording has")
        ->excludes(&self_calibrate);
    command.add_flag("--pfm", arguments->pfm, "write PFM too (for ranges that a PNG cannot hold: instead)");
    command.add_flag("--colour", arguments->colour, "write the left image beside coloured disparity too");
    command.add_flag("--force", arguments->force, "replace the files of an earlier run in DIR");
    command.add_flag("--json", arguments->json, "a summary as one JSON object");
    arguments->match.add_to(command, "default " + std::to_string(default_disparities));
    command.footer(
        "DIR gets 000000.png, ... (16-bit, disparity x 256, 0 = rejected), times.csv (time of each step per frame),\n"
        "geometry.json (calibration and options) and, where self-calibration changes it, corrections.csv. The same\n"
        "input gives the same pictures, whatever --workers is. Corrections of a recording are applied, not estimated.\n"
        "Damaged input: what comes before is processed, exit status 1. Ctrl-C: the frames in flight are finished,\n"
        "exit status 130.\n"
        "Example: disparityctl process walk.mkv --method sgm --disparities 128 -o out");
    command.callback([arguments, &action] { action = [arguments] { return process(*arguments); }; });
}

}  // namespace disparityd::tools
