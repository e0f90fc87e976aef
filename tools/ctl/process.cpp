// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>

#include "base/failure_text.h"
#include "base/memory_room.h"
#include "base/message_text.h"
#include "base/words.h"
#include "calibration/depth_range.h"
#include "calibration/empty_result/empty_result.h"
#include "capture/frame_source.h"
#include "capture/images/image_sequence.h"
#include "capture/images/mask_image.h"
#include "kernels/large_buffer.h"
#include "kernels/stage_notes.h"
#include "obstacles/mask_stage.h"
#include "obstacles/scan_stage.h"
#include "pipeline/calibrating_schedule.h"
#include "pipeline/distance_limits.h"
#include "pipeline/pipeline.h"
#include "pipeline/rectification_schedule.h"
#include "pipeline/temporal_stage.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/match_arguments.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/program.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/scan_arguments.h"
#include "tools/command_line/table.h"
#include "tools/ctl/colour_argument.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/distance_limit_arguments.h"
#include "tools/ctl/output_file.h"
#include "tools/ctl/process_output.h"
#include "tools/ctl/process_report.h"
#include "tools/ctl/scan/scan_csv.h"
#include "tools/ctl/source_arguments.h"
#include "tools/datasets/announced_range.h"
#include "tools/images/disparity_file.h"
#include "trust/trust_stage.h"

namespace disparityd::tools {
namespace {

/// Ends a source after a number of frames. Threads as FrameSource.
class LimitedSource final : public capture::FrameSource {
public:
    LimitedSource(std::unique_ptr<capture::FrameSource> source, std::uint64_t frames);

    const capture::SourceInfo& info() const override { return info_; }
    Next next(capture::RawFrame& frame, std::chrono::steady_clock::time_point deadline) override;
    void give_back(const capture::RawFrame& frame) noexcept override { source_->give_back(frame); }
    void interrupt() noexcept override { source_->interrupt(); }

private:
    std::unique_ptr<capture::FrameSource> source_;
    capture::SourceInfo info_;
    std::uint64_t left_;
};

LimitedSource::LimitedSource(std::unique_ptr<capture::FrameSource> source, std::uint64_t frames)
    : source_(std::move(source)), info_(source_->info()), left_(frames) {
    info_.frame_count = std::min(info_.frame_count.value_or(frames), frames);
}

capture::FrameSource::Next LimitedSource::next(capture::RawFrame& frame,
                                               std::chrono::steady_clock::time_point deadline) {
    if (left_ == 0) {
        return Next::end;
    }
    const Next got = source_->next(frame, deadline);
    if (got == Next::frame) {
        --left_;
    }
    return got;
}

constexpr int candidates_step = 16, most_candidates = 256;

std::string candidates(int first, int count) {
    return std::to_string(first) + " to " + std::to_string(first + count - 1) + " px";
}

/// Returns how many candidates are searched where the command line says nothing: as many as the files of a dataset ask
/// for (tools/datasets/announced_range.h), else `usual`. A note tells of it, and of a range that does not reach as far
/// as these files say. `calibration` is the file given instead of the source's own; empty: none.
int dataset_disparities(const std::string& source, const std::string& calibration, const MatchArguments& match,
                        int usual) {
    auto announced = datasets::range_of_images(source);
    if (!calibration.empty()) {
        const auto of_calibration = datasets::range_of_calibration(calibration);
        announced = of_calibration ? of_calibration : announced;
    }
    if (!announced) {
        return usual;
    }
    const int first = match.d_min();
    const double needed = std::ceil((std::floor(announced->largest) + 1 - first) / candidates_step) * candidates_step;
    const int taken = static_cast<int>(std::clamp(needed, double{candidates_step}, double{most_candidates}));
    const int searched = match.disparities().value_or(taken);
    if (searched < needed) {
        print_note(announced->origin + ", more than is searched: " + candidates(first, searched) +
                   "; what is nearer is not measured" +
                   (match.disparities() && taken > searched ? "; --disparities " + std::to_string(taken) +
                                                                  (taken < needed ? " reaches farther" : " reaches it")
                                                            : ""));
    } else if (!match.disparities() && taken != usual) {
        print_note(announced->origin + ": " + candidates(first, taken) + " are searched");
    }
    return taken;
}

constexpr int default_disparities = 64;

struct ProcessArguments {
    std::string source;
    std::string right;  ///< of a pair given as two names; `source` is the left one
    std::string folder;
    std::string method = "sgm";
    std::string backend = "auto";
    std::string calibration;
    std::string size;
    std::string region;
    std::string colours;
    std::string scan;  ///< file of the obstacle scans; empty: none
    ScanArguments scan_options;
    std::vector<std::string> mask_polygons;
    std::string mask_image;  ///< a file; empty: none
    DistanceLimitArguments distances;
    MatchArguments match;
    std::optional<int> workers;
    std::optional<int> frames;
    std::optional<int> time_offset_us;
    bool temporal = false;
    bool self_calibrate = false;
    bool no_self_calibration = false;
    bool pfm = false;
    bool colour = false;
    bool force = false;
    bool keep_going = false;
    bool json = false;
};

/// Parses whole numbers between separators, of which the last two are a width and a height. Throws
/// std::invalid_argument unless there are as many as wanted.
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

calibration::RectifiedGeometry geometry_of(const ProcessArguments& arguments) {
    calibration::RectifiedGeometry geometry;
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

/// Returns the parts to process one after the other: of images those that share size and calibration, of
/// anything else the whole.
std::vector<capture::RunOfOneGeometry> parts_of(const ProcessArguments& arguments) {
    std::vector<capture::RunOfOneGeometry> parts{{0, SIZE_MAX}};
    if (!arguments.keep_going && capture::is_image_sequence(arguments.source)) {
        parts = capture::runs_of_one_geometry(arguments.source, arguments.calibration.empty());
    }
    if (parts.size() > 1) {
        if (arguments.self_calibrate) {
            throw std::invalid_argument(
                "--self-calibrate: " + arguments.source +
                " has images of several sizes or calibrations, allowed: those of one camera and size");
        }
        if (arguments.temporal) {
            throw std::invalid_argument(
                "--temporal: " + arguments.source +
                " has images of several sizes or calibrations, allowed: frames of one camera, in their order");
        }
        print_note(arguments.source +
                   ": images of several sizes or calibrations, each pair is matched with its own; geometry.json has " +
                   std::to_string(parts.size()) + " parts");
    }
    return parts;
}

/// Opens a part of the source for at most so many frames.
std::unique_ptr<capture::FrameSource> open(const ProcessArguments& arguments, const capture::RunOfOneGeometry& part,
                                           std::optional<std::uint64_t> frames, int loans,
                                           std::vector<std::string>& left_out) {
    capture::SourceOptions options;
    options.uri = arguments.source;
    options.first_image = part.first;
    options.image_count = part.count;
    options.skip_damaged = arguments.keep_going;
    options.report = [&left_out](const std::string& line, bool trouble) {
        if (trouble) {
            left_out.push_back(line);
            print_note("left out: " + line);
        } else {
            print_note(line);
        }
    };
    options.loans = loans;
    options.pace = capture::Pace::fastest;
    options.calibration_path = arguments.calibration;
    options.time_offset_us = arguments.time_offset_us.value_or(0);
    auto source = open_with_progress(options);
    if (frames) {
        return std::make_unique<LimitedSource>(std::move(source), *frames);
    }
    if (source->info().live && !source->info().frame_count) {
        print_note(arguments.source + " has no end: Ctrl-C stops, or use --frames");
    }
    return source;
}

OutputFormats formats_of(const ProcessArguments& arguments, DisparityRange range) {
    OutputFormats formats{true, arguments.pfm, arguments.colour, colour_range(arguments.colours)};
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
void run_to_end(pipeline::Pipeline& pipeline, const std::optional<std::uint64_t>& total) {
    catch_interrupts();
    Progress bar("frames", total);
    pipeline.start();
    while (!pipeline.wait_until_ended(std::chrono::milliseconds(50)) && !interrupted()) {
        const pipeline::PipelineStatus now = pipeline.status();
        bar.show(now.published, fixed(now.rate, 1) + " frames/s");
    }
    pipeline.stop();
}

/// Says what rectifies each frame: the corrections that --self-calibrate estimates, those of the recording, or the
/// calibration alone.
struct Schedule {
    std::unique_ptr<pipeline::RectificationSchedule> frames;
    const pipeline::CalibratingSchedule* calibrating = nullptr;  ///< the same where it estimates
};

Schedule schedule_of(const ProcessArguments& arguments, const capture::SourceInfo& info, DisparityRange range) {
    const calibration::RectifiedGeometry geometry = geometry_of(arguments);
    if (arguments.self_calibrate) {
        auto estimating = std::make_unique<pipeline::CalibratingSchedule>(info, geometry, range,
                                                                          pipeline::CalibratingSchedule::Plan{});
        const pipeline::CalibratingSchedule* calibrating = estimating.get();
        return {std::move(estimating), calibrating};
    }
    const auto follow = arguments.no_self_calibration ? pipeline::CorrectedRectification::Follow::applied
                                                      : pipeline::CorrectedRectification::Follow::recorded;
    return {std::make_unique<pipeline::CorrectedRectification>(info, geometry, follow), nullptr};
}

/// What a run fills.
struct RunFiles {
    std::optional<ProcessOutput> folder;
    std::optional<ScanCsv> scans;
    std::optional<empty_result::EmptyResult> measured;
    std::uint64_t scans_by_mounting = 0;  ///< whose ground is the configured one
    TrustSummary trust;
};

/// Writes a frame's files. A lack of memory gets a message of its own.
void write(RunFiles& files, const pipeline::FrameSlot& slot) {
    try {
        const std::uint64_t frame = files.folder->frames();
        const trust::Verdict verdict = trust::verdict_of(slot.stage_memory[files.scans ? 1 : 0]);
        files.folder->write(slot, verdict);
        files.trust.add(verdict);
        files.measured->add(slot.view.left, slot.view.right, slot.view.confidence);
        if (files.scans) {
            const ScanRecord scan = scan_record(slot.stage_memory.front());
            files.scans->write({frame, slot.raw.sequence, slot.raw.monotonic_ns}, scan);
            files.scans_by_mounting += scan.head.ground == GroundSource::configured ? 1U : 0U;
        }
    } catch (const std::exception& error) {
        throw std::runtime_error(base::failure_text(error));
    }
}

/// Tells of scans that wanted to be level and had to do without.
void note_lack_of_level(const RunFiles& files, const std::optional<ScanOptions>& scan) {
    if (scan && scan->ground == GroundMode::autopilot) {
        print_note(
            "every sector is unknown: an autopilot's attitude is not recorded; take another ground, such as "
            "\"gravity\"");
    }
    if (scan && scan->ground == GroundMode::gravity && files.scans_by_mounting > 0) {
        print_note("the configured ground was taken for " + base::counted(files.scans_by_mounting, "frame") + " of " +
                   std::to_string(files.folder->frames()) +
                   ": no steady acceleration in the second before, or one more than 30 degrees off; check imu_axes");
    }
}

/// The folder of a file must be there, or be the one that is made.
void check_parent(const std::string& file, const std::string& folder) {
    namespace fs = std::filesystem;
    const fs::path parent = fs::absolute(file).lexically_normal().parent_path();
    std::error_code error;
    if (!fs::is_directory(parent, error) && parent != (fs::absolute(folder) / "").lexically_normal().parent_path()) {
        throw std::invalid_argument("--scan: " + file + ": there is no folder " + parent.string());
    }
}

/// Returns the options of the scan; nothing where none is wanted.
std::optional<ScanOptions> scan_of(const ProcessArguments& arguments, const MatchOptions& match) {
    if (arguments.scan.empty()) {
        return std::nullopt;
    }
    check_absent(arguments.scan, arguments.force);
    check_parent(arguments.scan, arguments.folder);
    return arguments.scan_options.options(match.method == Method::sgm && match.sgm.calibrated_confidence);
}

/// Without them every sector would be unknown, and no limit of distance would have an effect.
void check_metres(const ProcessArguments& arguments, const calibration::Rectification& rectification) {
    const pipeline::DistanceLimits limits = arguments.distances.limits();
    if ((arguments.scan.empty() && !limits.any()) || (rectification.f > 0 && rectification.baseline_mm > 0)) {
        return;
    }
    const std::string option = !arguments.scan.empty() ? "--scan"
                               : limits.min_m > 0      ? DistanceLimitArguments::min_option
                                                       : DistanceLimitArguments::max_option;
    throw std::invalid_argument(option + ": " + arguments.source +
                                " has no calibration, so no distance is known; give one with --calibration");
}

ImageMask mask_of(const ProcessArguments& arguments, const calibration::Rectification& rectification) {
    const capture::MaskImage file =
        arguments.mask_image.empty() ? capture::MaskImage{} : capture::read_mask_image(arguments.mask_image);
    return {rectification.width, rectification.height, arguments.mask_polygons, file.plane(), arguments.mask_image};
}

/// What the parts of a run share.
struct Run {
    const ProcessArguments& arguments;
    pipeline::PipelineConfig config;
    std::optional<ScanOptions> scan;
    MatchOptions options;
    pipeline::WorkerPool workers;
    RunFiles files;
    Schedule schedule;                                          ///< of the last part
    std::optional<calibration::StereoCalibration> calibration;  ///< where all parts have the same
    ProcessDone done;
};

/// Makes the folder for the first part, and tells it of the next ones.
void begin_files(Run& run, const capture::SourceInfo& info, const Matcher& matcher,
                 const calibration::Rectification& rectification, const std::vector<std::string>& steps) {
    if (run.files.folder) {
        run.files.folder->begin_part(info, rectification);
        return;
    }
    const ProcessArguments& arguments = run.arguments;
    const std::string substitute(matcher.substitute());
    run.files.folder.emplace(
        arguments.folder, arguments.force, formats_of(arguments, run.options.range), info, run.options, run.scan,
        substitute.empty() ? std::string(backend(arguments.backend).name) : substitute, rectification, steps);
    run.files.measured.emplace(run.options.range);
    if (run.scan) {
        run.files.scans.emplace(arguments.scan, arguments.force);
    }
}

/// Adds what people are told of the distances of a part.
void tell_distances(ProcessDone& done, const calibration::Rectification& rectification, const MatchOptions& options,
                    bool only_part) {
    done.range = calibration::DepthRange::of(rectification.f, rectification.baseline_mm, rectification.disparity_offset,
                                             options);
    std::string line = done.range ? done.range->text() : calibration::unknown_depth_range;
    if (!only_part) {
        done.range.reset();
        line.insert(0, base::size_text(rectification.width, rectification.height) + ": ");
    }
    if (std::find(done.distances.begin(), done.distances.end(), line) == done.distances.end()) {
        done.distances.push_back(line);
    }
}

void process_part(Run& run, const capture::RunOfOneGeometry& part, std::optional<std::uint64_t> frames,
                  bool only_part) {
    const ProcessArguments& arguments = run.arguments;
    const auto source = open(arguments, part, frames, run.config.slots + 2, run.done.left_out);
    const capture::SourceInfo& info = source->info();
    run.config.left_colour = arguments.colour && info.format != PixelFormat::grey8;
    run.schedule = schedule_of(arguments, info, run.options.range);
    const calibration::Rectification& rectification = run.schedule.frames->factory();
    check_metres(arguments, rectification);
    if (rectification.unrectified) {
        print_note(arguments.source + ": no calibration is known, frames are matched as they are");
    }
    const auto matcher = make_matcher(arguments.backend, {rectification.width, rectification.height, run.options});
    const ImageMask mask = mask_of(arguments, rectification);
    std::optional<ScanStage> scan_stage;
    std::optional<MaskStage> mask_stage;
    const auto notes = run.scan ? std::make_shared<StageNotes>() : nullptr;
    trust::TrustStage trust_stage(rectification.width, rectification.height, {}, mask.pixels(), notes);
    run.config.stages.clear();
    if (run.scan) {
        scan_stage.emplace(rectification.width, rectification.height, run.options.range, *run.scan, nullptr, mask,
                           notes);
        run.config.stages.push_back(&*scan_stage);
    }
    run.config.stages.push_back(&trust_stage);
    // What makes no record is last: records are found by their place in this list.
    if (!mask.empty()) {
        mask_stage.emplace(mask, run.options.range);
        run.config.stages.push_back(&*mask_stage);
    }
    std::optional<pipeline::TemporalStage> temporal_stage;
    if (arguments.temporal) {
        temporal_stage.emplace(rectification.width, rectification.height);
        run.config.stages.push_back(&*temporal_stage);
    }
    std::optional<pipeline::DistanceLimitStage> limit_stage;
    if (const pipeline::DistanceLimits limits = arguments.distances.limits(); limits.any()) {
        limit_stage.emplace(
            limits, run.options.range,
            pipeline::DistanceLimitNames{DistanceLimitArguments::min_option, DistanceLimitArguments::max_option});
        run.config.stages.push_back(&*limit_stage);
    }
    pipeline::Pipeline pipeline(run.config, *source, *matcher, run.workers, *run.schedule.frames,
                                [&run](const pipeline::FrameSlot& slot) { write(run.files, slot); });
    base::check_memory_room(large_memory_held(), base::memory_room());
    begin_files(run, info, *matcher, rectification, pipeline.steps());
    const auto start = std::chrono::steady_clock::now();
    run_to_end(pipeline, info.frame_count);
    run.done.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (const std::string trouble = matcher->trouble(); !trouble.empty()) {
        print_note(trouble);
    }
    if (const std::string notice = limit_stage ? limit_stage->notice() : std::string(); !notice.empty()) {
        print_note(notice);
    }
    const pipeline::PipelineStatus status = pipeline.status();
    run.done.damaged += status.damaged;
    run.done.error = status.error;
    run.done.frames = run.files.folder->frames();
    run.done.calibrating = run.schedule.calibrating;
    if (only_part) {
        run.calibration = info.calibration;
    }
    tell_distances(run.done, rectification, run.options, only_part);
}

int process(ProcessArguments arguments) {
    if (!arguments.right.empty()) {
        arguments.source += ',' + arguments.right;
    }
    ProcessOutput::check(arguments.folder, arguments.force);
    const Method method = parse_method(arguments.method);
    arguments.match.check_used({method});
    backend(arguments.backend);  // refuses an unknown one
    const MatchOptions options = arguments.match.options(
        method, dataset_disparities(arguments.source, arguments.calibration, arguments.match, default_disparities));
    pipeline::PipelineConfig config;
    config.policy = pipeline::Policy::replay;
    config.depth = false;
    const auto scan = scan_of(arguments, options);
    arguments.distances.limits();  // refuses those that leave nothing
    if (arguments.keep_going && !capture::is_image_sequence(arguments.source)) {
        print_note("--keep-going is for images; of " + arguments.source + " everything up to a damage is processed");
    }
    const auto parts = parts_of(arguments);

    Run run{arguments, config, scan, options, pipeline::WorkerPool(arguments.workers.value_or(0)), {}, {}, {}, {}};
    run.done.source = arguments.source;
    run.done.folder = arguments.folder;
    for (const capture::RunOfOneGeometry& part : parts) {
        const auto wanted = arguments.frames
                                ? std::optional(static_cast<std::uint64_t>(*arguments.frames) - run.done.frames)
                                : std::nullopt;
        if (wanted == std::uint64_t{0} || !run.done.error.empty() || interrupted()) {
            break;
        }
        process_part(run, part, wanted, parts.size() == 1);
    }
    run.files.folder->close();
    note_lack_of_level(run.files, run.scan);
    run.done.trust = run.files.trust;
    // What the limits reject was measured.
    if (!arguments.distances.limits().any()) {
        run.done.measured = run.files.measured->measured();
        run.done.empty_note = run.files.measured->note(run.calibration);
    }
    return report_process(run.done, arguments.json);
}

}  // namespace

void add_process(CLI::App& program, Action& action) {
    CLI::App& command =
        *program.add_subcommand("process", "Match every frame of a source into a folder of files, offline.");
    const auto arguments = std::make_shared<ProcessArguments>();
    command
        .add_option(
            "SOURCE", arguments->source,
            "a recording, a folder, a pattern with %d, scene:..., or the left image of a pair; see disparityctl "
            "sources")
        ->required();
    command.add_option("RIGHT", arguments->right, "the right image, where SOURCE is the left one");
    command.add_option("-o,--output", arguments->folder, "folder to fill; made when missing")
        ->type_name("DIR")
        ->required();
    command.add_option("--method", arguments->method, method_help() + "; default sgm")->type_name("METHOD");
    command.add_option("--backend", arguments->backend, backend_help())->type_name("NAME");
    command.add_option("--calibration", arguments->calibration, "calibration instead of the source's own")
        ->type_name("FILE");
    command.add_option("--size", arguments->size, "size of the rectified image; default: that of the capture")
        ->type_name("WxH");
    command.add_option("--region", arguments->region, "part of the rectified image to match; default: all of it")
        ->type_name("X,Y,W,H");
    add_integer(command, "--frames", arguments->frames, 1, 1'000'000'000, "stop after this many frames");
    add_time_offset(command, arguments->time_offset_us);
    add_integer(command, "--workers", arguments->workers, 0, 256, "worker threads; default 0: one per core");
    command.add_flag("--temporal", arguments->temporal,
                     "make a mean over time of disparities that agree, as [temporal] of the daemon does");
    CLI::Option& self_calibrate =
        *command.add_flag("--self-calibrate", arguments->self_calibrate,
                          "estimate corrections of the calibration from the frames, four times in every 80 frames");
    command
        .add_flag("--no-self-calibration", arguments->no_self_calibration,
                  "do not apply the corrections that a recording holds")
        ->excludes(&self_calibrate);
    command.add_flag("--pfm", arguments->pfm, "also write PFM (instead of PNG for ranges that a PNG cannot hold)");
    CLI::Option* const colour =
        command.add_flag("--colour", arguments->colour, "also write pictures: left image, coloured disparity, scale");
    add_colour_range(command, arguments->colours)->needs(colour);
    CLI::Option* const scan =
        command.add_option("--scan", arguments->scan, "also write obstacle scans: a line per frame and sector")
            ->type_name("FILE.csv")
            ->check([](const std::string& name) { return name.empty() ? "found no name" : std::string(); });
    arguments->scan_options.add_to(command)->needs(scan);
    command
        .add_option("--mask-polygon", arguments->mask_polygons,
                    "reject what lies in a polygon of the rectified left image; may be given several times")
        ->allow_extra_args(false)
        ->type_name("\"X,Y X,Y X,Y\"");
    command.add_option("--mask-image", arguments->mask_image, "reject where a grey image of that size is black")
        ->type_name("FILE");
    arguments->distances.add_to(command);
    command.add_flag("--force", arguments->force, "replace the files of an earlier run in DIR, and that of --scan");
    command.add_flag("--keep-going", arguments->keep_going,
                     "leave damaged images out and go on; they are listed, exit status 1");
    command.add_flag("--json", arguments->json, "a summary as one JSON object");
    // The daemon's default: the same bytes as from it.
    arguments->match.add_to(command,
                            "default " + std::to_string(default_disparities) + ", or what a dataset's files ask for",
                            Preset::obstacles);
    command.footer(
        "DIR gets a 16-bit PNG per frame (disparity x 256, 0 = rejected) with the name of the left image, or, of\n"
        "videos, 000000.png ...; times.csv (output, input and times of each frame); geometry.json (calibration and\n"
        "options); and corrections.csv where self-calibration changes something. The same input gives the same\n"
        "pictures for any number of --workers. Corrections of a recording are applied, not estimated. Of images with\n"
        "16 bits per channel the upper 8 are used (of 12, with ?bits=12 after SOURCE). Where the input is damaged,\n"
        "the frames before it are processed, exit status 1. After Ctrl-C the frames in flight are finished, exit\n"
        "status 130. One process at a time may fill DIR.\n"
        "Examples: disparityctl process walk.mkv --method sgm --disparities 128 -o out\n"
        "          disparityctl process left.png right.png -o out\n"
        "          disparityctl process walk.mkv -o out --scan walk.csv --scan-set camera_height_m=0.4");
    command.callback([arguments, &action] { action = [arguments] { return process(*arguments); }; });
}

}  // namespace disparityd::tools
