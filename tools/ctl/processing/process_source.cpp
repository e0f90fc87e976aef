// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/process_source.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <future>
#include <memory>
#include <stdexcept>
#include <utility>

#include "base/failure_text.h"
#include "base/memory_room.h"
#include "base/message_text.h"
#include "base/words.h"
#include "base/write_failure.h"
#include "calibration/empty_result/empty_result.h"
#include "capture/frame_source.h"
#include "kernels/large_buffer.h"
#include "kernels/stage_notes.h"
#include "obstacles/mask_stage.h"
#include "obstacles/scan_stage.h"
#include "pipeline/calibrating_schedule.h"
#include "pipeline/pipeline.h"
#include "pipeline/rectification_schedule.h"
#include "pipeline/temporal_stage.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/program.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/ctl/processing/input_files.h"
#include "tools/ctl/processing/process_output.h"
#include "tools/ctl/scan/scan_csv.h"
#include "tools/ctl/source_arguments.h"
#include "trust/trust_stage.h"

namespace disparityd::tools {
namespace {

/// Which frames of a part are processed.
struct FrameRange {
    std::uint64_t first = 0;
    std::optional<std::uint64_t> count;  ///< nothing: all behind it
    /// Gets the name of each good frame before the first one, in the thread that calls next(); may be empty.
    std::function<void(std::string_view name)> skipped;
};

/// Some frames of a source. Threads as FrameSource.
class LimitedSource final : public capture::FrameSource {
public:
    /// Throws std::invalid_argument where the source has no frame of the range, as far as that is known.
    LimitedSource(std::unique_ptr<capture::FrameSource> source, FrameRange range);

    const capture::SourceInfo& info() const override { return info_; }
    Next next(capture::RawFrame& frame, std::chrono::steady_clock::time_point deadline) override;
    void give_back(const capture::RawFrame& frame) noexcept override { source_->give_back(frame); }
    void interrupt() noexcept override { source_->interrupt(); }

private:
    std::unique_ptr<capture::FrameSource> source_;
    capture::SourceInfo info_;
    FrameRange range_;
    std::uint64_t left_;
};

LimitedSource::LimitedSource(std::unique_ptr<capture::FrameSource> source, FrameRange range)
    : source_(std::move(source)),
      info_(source_->info()),
      range_(std::move(range)),
      left_(range_.count.value_or(UINT64_MAX)) {
    if (info_.frame_count) {
        if (range_.first > 0 && range_.first >= *info_.frame_count) {
            throw std::invalid_argument("--first: found " + std::to_string(range_.first) + ", allowed: 0 .. " +
                                        std::to_string(*info_.frame_count - 1) + ", as " + info_.name + " has " +
                                        base::counted(*info_.frame_count, "frame"));
        }
        *info_.frame_count -= range_.first;
    }
    if (range_.count) {
        info_.frame_count = std::min(info_.frame_count.value_or(left_), left_);
    }
}

capture::FrameSource::Next LimitedSource::next(capture::RawFrame& frame,
                                               std::chrono::steady_clock::time_point deadline) {
    if (left_ == 0) {
        return Next::end;
    }
    Next got = source_->next(frame, deadline);
    for (; got == Next::frame && range_.first > 0; --range_.first) {
        const bool damaged = (frame.flags & capture::frame_flag_corrupt) != 0;  // these are in no run
        if (range_.skipped && !damaged) {
            range_.skipped(frame.name);
        }
        source_->give_back(frame);
        got = source_->next(frame, deadline);
    }
    if (got == Next::frame) {
        --left_;
    }
    return got;
}

/// Opens a part of the source for a range of its frames.
std::unique_ptr<capture::FrameSource> open(const ProcessArguments& arguments, const capture::RunOfOneGeometry& part,
                                           FrameRange frames, int loans,
                                           std::function<void(const std::string&, bool)> report) {
    capture::SourceOptions options;
    options.uri = arguments.source;
    options.first_image = part.first;
    options.image_count = part.count;
    options.skip_damaged = arguments.keep_going;
    options.report = std::move(report);
    options.loans = loans;
    options.pace = capture::Pace::fastest;
    options.calibration_path = arguments.calibration;
    options.time_offset_us = arguments.time_offset_us.value_or(0);
    auto source = open_with_progress(options);
    if (frames.first > 0 || frames.count) {
        return std::make_unique<LimitedSource>(std::move(source), std::move(frames));
    }
    return source;
}

std::optional<std::uint64_t> frames_of(const ProcessArguments& arguments) {
    return arguments.frames ? std::optional(static_cast<std::uint64_t>(*arguments.frames)) : std::nullopt;
}

/// Runs the pipeline to its end, or to the end of the frames in flight after Ctrl-C.
void run_to_end(pipeline::Pipeline& pipeline, const std::optional<std::uint64_t>& total, const Shown& shown) {
    Progress bar(shown.what, total);
    pipeline.start();
    while (!pipeline.wait_until_ended(std::chrono::milliseconds(50)) && !interrupted()) {
        const pipeline::PipelineStatus now = pipeline.status();
        const double share = total && *total > 0 ? static_cast<double>(now.published) / static_cast<double>(*total) : 0;
        bar.show(now.published,
                 fixed(now.rate, 1) + " frames/s" + shown.more + (shown.left ? shown.left(share) : std::string()));
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

/// Reads the input a second time, in a thread of its own, for the SHA-256 of all its bytes.
class InputDigest {
public:
    explicit InputDigest(const std::string& uri)
        : digest_(std::async(std::launch::async, [this, uri] {
              return content_of_input(uri,
                                      [this] { return interrupted() || given_up_.load(std::memory_order_relaxed); });
          })) {}
    ~InputDigest() { given_up_.store(true, std::memory_order_relaxed); }
    InputDigest(const InputDigest&) = delete;
    InputDigest& operator=(const InputDigest&) = delete;

    /// Waits for it. Throws as content_of_input(). Null after a signal.
    Json get() { return digest_.get(); }

private:
    std::atomic<bool> given_up_{false};
    std::future<Json> digest_;  // last: its end waits for the thread, which asks the other
};

/// What a run fills.
struct RunFiles {
    std::optional<ProcessOutput> folder;
    std::optional<ScanCsv> scans;
    std::optional<empty_result::EmptyResult> measured;
    std::uint64_t scans_by_mounting = 0;  ///< whose ground is the configured one
    TrustSummary trust;
    bool judged = true;  ///< by the trust stage
    bool disk_full = false;
};

/// Does what writes files. A lack of memory gets a message of its own.
template <typename Step>
void write_to(RunFiles& files, Step step) {
    try {
        step();
    } catch (const base::DiskFull&) {
        files.disk_full = true;
        throw;
    } catch (const std::exception& error) {
        throw std::runtime_error(base::failure_text(error));
    }
}

/// Writes a frame's files.
void write(RunFiles& files, const pipeline::FrameSlot& slot) {
    write_to(files, [&] {
        const std::uint64_t frame = files.folder->frames();
        const trust::Verdict verdict =
            files.judged ? trust::verdict_of(slot.stage_memory[files.scans ? 1 : 0]) : trust::Verdict{};
        files.folder->write(slot, verdict);
        files.trust.add(verdict);
        files.measured->add(slot.view.left, slot.view.right, slot.view.confidence);
        if (files.scans) {
            const ScanRecord scan = scan_record(slot.stage_memory.front());
            files.scans->write({frame, slot.raw.sequence, slot.raw.monotonic_ns}, scan);
            files.scans_by_mounting += scan.head.ground == GroundSource::configured ? 1U : 0U;
        }
    });
}

/// Waits until the files of all frames are written. Returns what went wrong; empty: nothing.
std::string settle(RunFiles& files) {
    try {
        write_to(files, [&files] { files.folder->settle(); });
        return {};
    } catch (const std::exception& error) {
        return error.what();
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

/// What the parts of a run share.
struct Run {
    const ProcessArguments& arguments;
    pipeline::PipelineConfig config;
    std::optional<ScanOptions> scan;
    MatchOptions options;
    pipeline::WorkerPool& workers;
    const Shown& shown;
    RunFiles files;
    std::optional<calibration::StereoCalibration> calibration;  ///< where all parts have the same
    bool endless = false;                                       ///< only a signal ends it
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
    run.files.folder.emplace(run.workers, arguments.folder, replacing(arguments),
                             formats_of(arguments, run.options.range), info, run.options, run.scan,
                             substitute.empty() ? std::string(backend(arguments.backend).name) : substitute,
                             rectification, steps, parameters_of(arguments, run.options, run.scan), arguments.scan);
    run.files.measured.emplace(run.options.range);
    if (run.scan) {
        run.files.scans.emplace(arguments.scan, arguments.force || arguments.resume);
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

/// Returns the names of what depends on the frames before; empty: nothing does.
std::string names_of_dependent(const Run& run) {
    std::string names;
    const auto add = [&names](std::string_view name) { names.append(names.empty() ? "" : ", ").append(name); };
    for (const AddedStage* stage : run.config.stages) {
        if (stage->depends_on_earlier_frames()) {
            add(stage->name());
        }
    }
    if (run.options.adaptive_noise) {
        add("adaptive-noise");
    }
    if (run.arguments.self_calibrate) {
        add("self-calibrate");
    }
    return names;
}

/// Refuses a range that would be another one than that of the whole.
void check_range(const Run& run) {
    const std::string names = run.arguments.first.value_or(0) > 0 ? names_of_dependent(run) : std::string();
    if (!names.empty()) {
        throw std::invalid_argument("--first: what is made of a frame depends on the frames before (" + names +
                                    "), so a range would differ from the whole; allowed without these: --no-trust "
                                    "--no-adaptive-noise, and no --scan, --temporal and --self-calibrate");
    }
}

/// Says why a source that was begun is not gone on with.
void tell_new_begin(const Run& run) {
    const std::string names = names_of_dependent(run);
    if (run.files.folder->replaces_unfinished() && run.files.folder->frames() == 0) {
        print_note(run.arguments.folder + ": was not finished; it begins anew" +
                   (names.empty() ? "" : ", as what it tells of a frame depends on the frames before (" + names + ")"));
    }
}

void process_part(Run& run, const capture::RunOfOneGeometry& part, std::optional<std::uint64_t> frames,
                  bool only_part) {
    const ProcessArguments& arguments = run.arguments;
    const auto source = open(arguments, part,
                             {static_cast<std::uint64_t>(arguments.first.value_or(0)), frames,
                              [&run](std::string_view name) { run.files.folder->skip(name); }},
                             run.config.slots + 2, [&run](const std::string& line, bool trouble) {
                                 if (trouble) {
                                     run.done.left_out.push_back(line);
                                 }
                                 print_note((trouble ? "left out: " : "") + line);
                             });
    const capture::SourceInfo& info = source->info();
    run.endless = info.live && !info.frame_count;
    if (run.endless) {
        print_note(arguments.source + " has no end: Ctrl-C stops, or use --frames");
    }
    const bool colours = info.format != PixelFormat::grey8;
    const MoreOutputs& more = arguments.more;
    run.config.left_colour = colours && (arguments.colour || more.rectified || !more.points.empty());
    run.config.right_colour = colours && more.rectified;
    run.config.depth = more.depth;
    if (more.depth_error) {
        run.config.depth_error = static_cast<int>(std::lround(subpixel_error_px(arguments) * 256));
    }
    const Schedule schedule = schedule_of(arguments, info, run.options.range);
    const calibration::Rectification& rectification = schedule.frames->factory();
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
    run.files.judged = !arguments.no_trust;
    if (run.files.judged) {
        run.config.stages.push_back(&trust_stage);
    }
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
    check_range(run);
    pipeline::Pipeline pipeline(run.config, *source, *matcher, run.workers, *schedule.frames,
                                [&run](const pipeline::FrameSlot& slot) { write(run.files, slot); });
    base::check_memory_room(large_memory_held(), base::memory_room());
    begin_files(run, info, *matcher, rectification, pipeline.steps());
    tell_new_begin(run);
    const auto start = std::chrono::steady_clock::now();
    run_to_end(pipeline, info.frame_count, run.shown);
    const std::string unwritten = settle(run.files);
    run.done.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (const std::string trouble = matcher->trouble(); !trouble.empty()) {
        print_note(trouble);
    }
    if (const std::string notice = limit_stage ? limit_stage->notice() : std::string(); !notice.empty()) {
        print_note(notice);
    }
    const pipeline::PipelineStatus status = pipeline.status();
    run.done.damaged += status.damaged;
    run.done.error = status.error.empty() ? unwritten : status.error;
    run.done.again = run.files.disk_full;
    run.done.frames = run.files.folder->written();
    if (schedule.calibrating != nullptr) {
        run.done.estimates = schedule.calibrating->estimates();
    }
    if (only_part) {
        run.calibration = info.calibration;
    }
    tell_distances(run.done, rectification, run.options, only_part);
}

}  // namespace

std::vector<capture::SourceInfo> infos_of(const ProcessArguments& arguments) {
    std::vector<capture::SourceInfo> all;
    auto wanted = frames_of(arguments);
    for (const capture::RunOfOneGeometry& part : parts_of(arguments)) {
        if (wanted == std::uint64_t{0}) {
            break;
        }
        const FrameRange range{static_cast<std::uint64_t>(arguments.first.value_or(0)), wanted, {}};
        all.push_back(open(arguments, part, range, 2, [](const std::string&, bool) {})->info());
        if (wanted) {
            *wanted -= all.back().frame_count.value_or(*wanted);
        }
    }
    return all;
}

ProcessDone process_source(const ProcessArguments& arguments, pipeline::WorkerPool& workers, const Shown& shown) {
    const MatchOptions options = match_options(arguments);
    pipeline::PipelineConfig config;
    config.policy = pipeline::Policy::replay;
    const auto scan = scan_of(arguments, options);
    const auto parts = parts_of(arguments);
    if (parts.size() > 1) {
        print_note(arguments.source +
                   ": images of several sizes or calibrations, each pair is matched with its own; geometry.json has " +
                   std::to_string(parts.size()) + " parts");
    }

    std::optional<InputDigest> input;
    if (arguments.hash_inputs) {
        input.emplace(arguments.source);
    }
    Run run{arguments, config, scan, options, workers, shown, {}, {}, false, {}};
    run.done.source = arguments.source;
    run.done.folder = arguments.folder;
    for (const capture::RunOfOneGeometry& part : parts) {
        auto wanted = frames_of(arguments);
        if (wanted) {
            *wanted -= run.done.frames;
        }
        if (wanted == std::uint64_t{0} || !run.done.error.empty() || interrupted()) {
            break;
        }
        process_part(run, part, wanted, parts.size() == 1);
    }
    if (!run.files.folder) {
        return run.done;  // Ctrl-C came before the first part
    }
    run.files.folder->close();
    bool finished = run.done.error.empty() && !interrupted() && run.done.frames > 0;
    const Json input_digest = finished && input ? input->get() : Json();
    finished = finished && !interrupted();
    // A part of the scans must not look whole. What has no end is whole when a signal ends it.
    if (run.files.scans && (finished || (run.endless && run.done.error.empty()))) {
        run.files.scans->finish();
    } else if (run.files.scans) {
        print_note(arguments.scan + ": not written, as the source was not finished; " +
                   GrowingFile::part_of(arguments.scan) + " has the scans until then");
    }
    if (finished) {
        run.files.folder->finish({{"damaged", run.done.damaged}, {"left_out", run.done.left_out}}, arguments.scan,
                                 input_digest);
    }
    note_lack_of_level(run.files, run.scan);
    run.done.trust = run.files.trust;
    // What the limits reject was measured.
    if (!arguments.distances.limits().any()) {
        run.done.measured = run.files.measured->measured();
        run.done.empty_note = run.files.measured->note(run.calibration);
    }
    return run.done;
}

}  // namespace disparityd::tools
