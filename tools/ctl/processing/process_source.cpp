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
#include "base/message_text.h"
#include "base/words.h"
#include "base/write_failure.h"
#include "calibration/empty_result/empty_result.h"
#include "capture/frame_source.h"
#include "pipeline/pipeline.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/program.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/ctl/processing/frame_chain.h"
#include "tools/ctl/processing/input_files.h"
#include "tools/ctl/processing/part_source.h"
#include "tools/ctl/processing/process_output.h"
#include "tools/ctl/scan/scan_csv.h"

namespace disparityd::tools {
namespace {

/// Runs the pipeline to its end, or to the end of the frames in flight after Ctrl-C.
void run_to_end(pipeline::Pipeline& pipeline, const std::optional<std::uint64_t>& total, const Shown& shown) {
    Progress bar(shown.what, total);
    tools::run_to_end(pipeline, [&](const pipeline::PipelineStatus& now) {
        const double share = total && *total > 0 ? static_cast<double>(now.published) / static_cast<double>(*total) : 0;
        bar.show(now.published,
                 fixed(now.rate, 1) + " frames/s" + shown.more + (shown.left ? shown.left(share) : std::string()));
    });
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
void write(RunFiles& files, const FrameChain& chain, const pipeline::FrameSlot& slot) {
    write_to(files, [&] {
        const std::uint64_t frame = files.folder->frames();
        const trust::Verdict verdict = chain.verdict_of(slot);
        files.folder->write(slot, verdict);
        files.trust.add(verdict);
        files.measured->add(slot.view.left, slot.view.right, slot.view.confidence);
        if (files.scans) {
            const ScanRecord scan = scan_record(chain.scan_bytes_of(slot));
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
                             rectification, steps, parameters_of(arguments, run.options, run.scan), arguments.scan,
                             arguments.whole_frames ? Numbers::of_whole : Numbers::of_run);
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

/// Refuses a range that would be another one than that of the whole.
void check_range(const Run& run, const FrameChain& chain) {
    const bool ranged = run.arguments.first.value_or(0) > 0 || run.arguments.split;
    const std::string names = ranged ? chain.names_of_dependent() : std::string();
    if (!names.empty()) {
        throw std::invalid_argument((run.arguments.split ? "--split" : "--first") +
                                    std::string(": what is made of a frame depends on the frames before (") + names +
                                    "), so a range would differ from the whole; allowed without these: --no-trust "
                                    "--no-adaptive-noise, and no --scan, --temporal and --self-calibrate");
    }
}

/// Says why a source that was begun is not gone on with.
void tell_new_begin(const Run& run, const FrameChain& chain) {
    const std::string names = chain.names_of_dependent();
    if (run.files.folder->replaces_unfinished() && run.files.folder->frames() == 0) {
        print_note(run.arguments.folder + ": was not finished; it begins anew" +
                   (names.empty() ? "" : ", as what it tells of a frame depends on the frames before (" + names + ")"));
    }
}

/// What is told of a range of --split is what is told of the whole.
capture::SourceInfo as_of_whole(const ProcessArguments& arguments, capture::SourceInfo info) {
    info.frame_count = arguments.whole_frames ? arguments.whole_frames : info.frame_count;
    return info;
}

void process_part(Run& run, const capture::RunOfOneGeometry& part, std::optional<std::uint64_t> frames,
                  bool only_part) {
    const ProcessArguments& arguments = run.arguments;
    const auto source = open_part(arguments, part,
                                  {static_cast<std::uint64_t>(arguments.first.value_or(0)), frames,
                                   [&run](const capture::RawFrame& frame) { run.files.folder->skip(frame); }},
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
    FrameChain chain(arguments, run.options, run.scan, *source, run.config, run.workers);
    check_metres(arguments, chain.rectification());
    if (chain.rectification().unrectified) {
        print_note(arguments.source + ": no calibration is known, frames are matched as they are");
    }
    check_range(run, chain);
    pipeline::Pipeline& pipeline =
        chain.connect([&run, &chain](const pipeline::FrameSlot& slot) { write(run.files, chain, slot); });
    begin_files(run, as_of_whole(arguments, info), chain.matcher(), chain.rectification(), pipeline.steps());
    tell_new_begin(run, chain);
    const auto start = std::chrono::steady_clock::now();
    run_to_end(pipeline, info.frame_count, run.shown);
    const std::string unwritten = settle(run.files);
    run.done.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const std::string& note : chain.notes()) {
        print_note(note);
    }
    const pipeline::PipelineStatus status = pipeline.status();
    run.done.damaged += status.damaged;
    run.done.error = status.error.empty() ? unwritten : status.error;
    run.done.again = run.files.disk_full;
    run.done.frames = run.files.folder->written();
    if (chain.calibrating() != nullptr) {
        run.done.estimates = chain.calibrating()->estimates();
    }
    if (only_part) {
        run.calibration = info.calibration;
    }
    tell_distances(run.done, chain.rectification(), run.options, only_part);
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
        const auto source = open_part(arguments, part, range, 2, [](const std::string&, bool) {});
        if (wanted) {
            *wanted -= source->info().frame_count.value_or(*wanted);
        }
        all.push_back(as_of_whole(arguments, source->info()));
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
