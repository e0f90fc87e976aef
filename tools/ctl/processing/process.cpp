// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/failure_text.h"
#include "base/words.h"
#include "base/write_failure.h"
#include "capture/images/image_sequence.h"
#include "pipeline/worker_pool.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/program.h"
#include "tools/command_line/table.h"
#include "tools/ctl/colour_argument.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/processing/matching_options.h"
#include "tools/ctl/processing/process_arguments.h"
#include "tools/ctl/processing/process_output.h"
#include "tools/ctl/processing/process_report.h"
#include "tools/ctl/processing/process_source.h"
#include "tools/ctl/processing/resume.h"
#include "tools/ctl/processing/shards/join_ranges.h"
#include "tools/ctl/processing/shards/plan.h"
#include "tools/ctl/processing/shards/source_list.h"
#include "tools/ctl/processing/shards/split_source.h"
#include "tools/ctl/processing/submission.h"

namespace disparityd::tools {
namespace {

/// Daemons on this computer keep their cores, and other runs theirs.
constexpr auto pinning = pipeline::Pinning::never;

/// Returns the arguments for one source of a list.
ProcessArguments for_source(ProcessArguments arguments, const ListedSource& source, bool of_list) {
    arguments.source = source.uri;
    arguments.folder = source.folder;
    if (of_list && !arguments.scan.empty()) {
        arguments.scan = source.folder + '/' + arguments.scan;
    }
    return arguments;
}

/// Returns what `step` returns. What keeps the source from beginning is told in what is returned, too.
template <typename Step>
ProcessDone attempt(const ProcessArguments& arguments, Step step) {
    ProcessDone failed;
    try {
        return step();
    } catch (const base::DiskFull& error) {
        failed.refusal = error.what();
        failed.status = exit_again;
    } catch (const std::invalid_argument& error) {
        failed.refusal = error.what();
        failed.status = exit_user;
    } catch (const std::exception& error) {
        failed.refusal = base::failure_text(error);
        failed.status = exit_failed;
    }
    failed.source = arguments.source;
    failed.folder = arguments.folder;
    return failed;
}

/// A source to process, or what an earlier run has done of it.
struct Task {
    ListedSource source;
    std::optional<SplitSource> split;
    std::optional<ProcessDone> before;
};

/// Whether all of it is there.
bool is_whole(const ProcessDone& done) {
    return done.refusal.empty() && done.error.empty() && done.left_out.empty() && done.frames > 0 && !interrupted();
}

/// Does what follows when all frames are there, and keeps what goes wrong.
template <typename Step>
void guarded(ProcessDone& done, Step step) {
    try {
        step();
    } catch (const base::DiskFull& error) {
        done.error = error.what();
        done.again = true;
    } catch (const std::exception& error) {
        done.error = base::failure_text(error);
    }
}

/// Joins the ranges of a source where the last one is finished now.
void try_to_join(const SplitSource& split, ProcessDone& done) {
    if (!is_whole(done)) {
        return;
    }
    const std::string ranges = base::counted(split.ranges.size(), "range");
    guarded(done, [&] {
        if (const auto frames = join_ranges(split)) {
            done.folder = split.folder;
            print_note(split.folder + ": joined from " + ranges + ", " + base::counted(*frames, "frame"));
        } else {
            print_note(split.folder + ": is joined when all of its " + ranges + " are finished");
        }
    });
}

/// Writes what a benchmark's server takes, where the source is whole.
void try_to_submit(const ProcessArguments& arguments, ProcessDone& done) {
    if (arguments.submission.empty() || !done.refusal.empty()) {
        return;
    }
    if (!is_whole(done)) {
        print_note(done.folder + ": not all frames are there, nothing is written for the submission");
        return;
    }
    guarded(done, [&] {
        print_note(write_submission(parse_submission(arguments.submission, arguments.submission_name, arguments.folder),
                                    done));
    });
}

/// Does a task, of whose source these are the arguments.
ProcessDone perform(const ProcessArguments& arguments, const Task& task, pipeline::WorkerPool& workers,
                    const Shown& shown) {
    const ProcessArguments own = task.split ? task.split->arguments(arguments) : arguments;
    ProcessDone done = task.before ? *task.before : attempt(own, [&] { return process_source(own, workers, shown); });
    if (task.split) {
        try_to_join(*task.split, done);
    }
    if (!task.split || done.folder == task.split->folder) {
        try_to_submit(arguments, done);
    }
    return done;
}

int process_one(const ProcessArguments& arguments, const Task& task, pipeline::WorkerPool& workers) {
    if (!task.before && arguments.keep_going && !capture::is_image_sequence(arguments.source)) {
        print_note("--keep-going is for images; of " + arguments.source + " everything up to a damage is processed");
    }
    return report_process(perform(arguments, task, workers, {}), arguments.json);
}

/// Returns "40 s", "12 min" or "3.5 h".
std::string rounded_time(double seconds) {
    constexpr double minute = 60, hour = 3600;
    if (seconds < 1.5 * minute) {
        return fixed(seconds, 0) + " s";
    }
    return seconds < 1.5 * hour ? fixed(seconds / minute, 0) + " min" : fixed(seconds / hour, 1) + " h";
}

/// Tells how long the rest of a list takes, if its sources take as long as those before.
class TimeLeft {
public:
    explicit TimeLeft(const std::vector<Task>& tasks)
        : left_(static_cast<double>(
              std::count_if(tasks.begin(), tasks.end(), [](const Task& task) { return !task.before; }))) {}

    /// Returns ", 12 min left" where that share of the source at hand is done; empty while nothing is known.
    std::string text(double share) const {
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start_;
        const double done = done_ + share;
        return done > 0 ? ", " + rounded_time(passed.count() * (left_ - share) / done) + " left" : std::string();
    }

    void finished_one() {
        ++done_;
        --left_;
    }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    double done_ = 0;
    double left_;
};

/// `sources` counts those, too, for which a signal left no task.
int process_list(const ProcessArguments& arguments, const std::vector<Task>& tasks, std::size_t sources,
                 pipeline::WorkerPool& workers) {
    ListReport report(arguments.folder, sources, arguments.json);
    TimeLeft left(tasks);
    for (std::size_t i = 0; i < tasks.size() && !interrupted(); ++i) {
        const Shown shown{"source " + std::to_string(i + 1) + '/' + std::to_string(sources) + ", frames",
                          report.failed() == 0 ? std::string()
                                               : std::string(", ").append(std::to_string(report.failed())) + " failed",
                          [&left](double share) { return left.text(share); }};
        const Task& task = tasks[i];
        const int status = report.add(perform(for_source(arguments, task.source, true), task, workers, shown));
        if (!task.before) {
            left.finished_one();
        }
        if (status == exit_again || (status != exit_done && !arguments.keep_going)) {
            break;
        }
    }
    return report.finish();
}

/// Returns the sources of the command line and of --list.
std::vector<std::string> words_of(const ProcessArguments& arguments) {
    std::vector<std::string> words = arguments.sources;
    if (!arguments.list.empty()) {
        const std::vector<std::string> lines = lines_of(arguments.list);
        words.insert(words.end(), lines.begin(), lines.end());
    }
    if (words.empty()) {
        throw std::invalid_argument("SOURCE: found none" +
                                    (arguments.list.empty() ? std::string() : " in " + arguments.list) +
                                    ", allowed: at least one, here or in the file of --list");
    }
    return words;
}

/// Looks at what is there of the source. Nothing: --split leaves no frame of it to this shard.
std::optional<Task> task_of(const ProcessArguments& arguments, const ListedSource& source) {
    Task task{source, std::nullopt, std::nullopt};
    if (!arguments.split) {
        ProcessOutput::check(source.folder, replacing(arguments));
        task.before = arguments.resume ? finished_before(arguments) : std::nullopt;
        return task;
    }
    if (arguments.resume && (task.before = finished_before(arguments))) {
        remove_joined_ranges(source.folder);
        return task;
    }
    task.split = split_source(arguments, parse_shard(arguments.shard));
    if (!task.split) {
        return std::nullopt;
    }
    ProcessOutput::check(task.split->mine.folder, replacing(arguments));
    task.before = arguments.resume ? finished_before(task.split->arguments(arguments)) : std::nullopt;
    return task;
}

/// The same. With --keep-going what a range cannot be cut of is told when its turn comes, as other sources that fail.
std::optional<Task> task_or_failure_of(const ProcessArguments& arguments, const ListedSource& source) {
    if (!arguments.split || !arguments.keep_going) {
        return task_of(arguments, source);
    }
    std::optional<Task> task;
    const ProcessDone failed = attempt(arguments, [&] {
        task = task_of(arguments, source);
        return ProcessDone();
    });
    return failed.refusal.empty() ? task : Task{source, std::nullopt, failed};
}

int process(const ProcessArguments& arguments) {
    catch_interrupts();
    if (arguments.folder.empty() && !arguments.plan) {
        throw std::invalid_argument("--output: found nothing, allowed: the folder to fill");
    }
    const std::vector<ListedSource> all = list_sources(words_of(arguments), arguments.folder);
    const bool is_list = all.size() > 1;
    if (is_list && std::filesystem::path(arguments.scan).has_parent_path()) {
        throw std::invalid_argument("--scan: found '" + arguments.scan +
                                    "', allowed with several sources: a name without a folder; the folder of each "
                                    "source gets such a file");
    }
    check(arguments);
    if (!arguments.submission.empty() && !arguments.plan) {
        std::vector<std::string> sources;
        std::transform(all.begin(), all.end(), std::back_inserter(sources),
                       [](const ListedSource& listed) { return listed.uri; });
        check_submission(parse_submission(arguments.submission, arguments.submission_name, arguments.folder), sources,
                         arguments.force || arguments.resume);
    }
    const std::vector<ListedSource> mine = arguments.split ? in_order(all) : shard_of(all, arguments.shard);
    if (arguments.plan) {
        pipeline::WorkerPool workers(arguments.workers.value_or(0), pinning);
        return plan(arguments, mine, workers);
    }
    std::vector<Task> tasks;
    std::size_t sources = mine.size();
    for (const ListedSource& source : mine) {
        if (interrupted() && !tasks.empty()) {
            break;
        }
        if (auto task = task_or_failure_of(for_source(arguments, source, is_list), source)) {
            tasks.push_back(std::move(*task));
        } else {
            --sources;
        }
    }
    if (tasks.empty()) {
        print_note("--shard " + arguments.shard + ": " + (arguments.split ? "no frame of the " : "none of the ") +
                   base::counted(all.size(), "source") + " belongs to it, nothing to do");
        return exit_done;
    }
    pipeline::WorkerPool workers(arguments.workers.value_or(0), pinning);
    return is_list ? process_list(arguments, tasks, sources, workers)
                   : process_one(for_source(arguments, tasks.front().source, false), tasks.front(), workers);
}

}  // namespace

void add_process(CLI::App& program, Action& action) {
    CLI::App& command =
        *program.add_subcommand("process", "Match every frame of a source into a folder of files, offline.");
    const auto arguments = std::make_shared<ProcessArguments>();
    command.add_option(
        "SOURCE", arguments->sources,
        "recordings, folders, patterns with %d, scene:..., or the two images of one pair; see disparityctl "
        "sources");
    command.add_option("--list", arguments->list, "more sources: a file with one a line")->type_name("FILE");
    command
        .add_option("-o,--output", arguments->folder,
                    "folder to fill; made when missing; several sources get a folder of their own name in it each; "
                    "needed but with --plan")
        ->type_name("DIR");
    add_matching_options(command, *arguments);
    add_integer(command, "--first", arguments->first, 0, 1'000'000'000,
                "begin with the frame of this number, counted from 0; only with what depends on no frame before");
    command.add_flag("--pfm", arguments->pfm, "also write PFM (instead of PNG for ranges that a PNG cannot hold)");
    command.add_flag("--depth", arguments->more.depth, "also write depth in mm, as a 16-bit PNG");
    command.add_flag("--depth-error", arguments->more.depth_error,
                     "also write one sigma of the depth in mm, as a 16-bit PNG");
    command.add_flag("--confidence", arguments->more.confidence, "also write the confidence, as an 8-bit PNG");
    command.add_flag("--rectified", arguments->more.rectified,
                     "also write the rectified pair, and calib.txt with its K and baseline as Middlebury has it");
    command.add_option("--points", arguments->more.points, "also write points in metres with colours: ply or pcd")
        ->type_name("FORMAT")
        ->check(CLI::IsMember({"ply", "pcd"}));
    CLI::Option* const colour =
        command.add_flag("--colour", arguments->colour, "also write pictures: left image, coloured disparity, scale");
    add_colour_range(command, arguments->colours)->needs(colour);
    CLI::Option* const scan =
        command.add_option("--scan", arguments->scan, "also write obstacle scans: a line per frame and sector")
            ->type_name("FILE.csv")
            ->check([](const std::string& name) { return name.empty() ? "found no name" : std::string(); });
    arguments->scan_options.add_to(command)->needs(scan);
    command
        .add_option("--submission", arguments->submission,
                    "also write results as the server of a benchmark takes them: kitti2012, kitti2015, middlebury or "
                    "eth3d, and a folder beside DIR")
        ->type_name("BENCHMARK=FOLDER")
        ->excludes("--first", "--frames");
    command
        .add_option("--submission-name", arguments->submission_name,
                    "name of the method in files of Middlebury, default disparityd")
        ->needs("--submission")
        ->type_name("NAME");
    CLI::Option* const force =
        command.add_flag("--force", arguments->force, "replace the files of an earlier run in DIR, and that of --scan");
    command
        .add_flag("--resume", arguments->resume,
                  "leave alone what an earlier run has finished with the same options, do the rest")
        ->excludes(force);
    command.add_flag("--hash-inputs", arguments->hash_inputs,
                     "also the SHA-256 of all bytes of the input in the manifest, which --resume compares then");
    command.add_flag("--keep-going", arguments->keep_going,
                     "leave damaged images out, and sources that fail; they are listed, exit status 1");
    CLI::Option* const shard =
        command
            .add_option(
                "--shard", arguments->shard,
                "process only every N-th of the sources, in the order of their names, from number I on; I is 0 to "
                "N - 1")
            ->type_name("I/N");
    command
        .add_flag("--split", arguments->split,
                  "with --shard: every source is cut into N ranges of frames, of which shard I does one; the last one "
                  "to end joins them; only with what depends on no frame before")
        ->excludes("--first", "--frames", "--scan");
    command
        .add_flag("--plan", arguments->plan,
                  "write nothing: tell how many frames there are, and how long they take in how many shards, by some "
                  "frames of the first sources")
        ->excludes(shard);
    command.add_flag("--json", arguments->json, "a summary as one JSON object");
    command.footer(
        "DIR gets a 16-bit PNG per frame (disparity x 256, 0 = rejected) with the name of the left image, or, of\n"
        "videos, 000000.png ...; times.csv (output, input and times of each frame); geometry.json (calibration and\n"
        "options); and corrections.csv where self-calibration changes something. The same input gives the same\n"
        "pictures for any number of --workers. Corrections of a recording are applied, not estimated. Of images with\n"
        "16 bits per channel the upper 8 are used (of 12, with ?bits=12 after SOURCE). Where the input is damaged,\n"
        "the frames before it are processed, exit status 1. After Ctrl-C the frames in flight are finished, exit\n"
        "status 130. Exit status 75: a full disk, SIGTERM or SIGHUP ended it, and --resume may go on. One process\n"
        "at a time may fill a folder.\n"
        "Examples: disparityctl process walk.mkv --method sgm --disparities 128 -o out\n"
        "          disparityctl process left.png right.png -o out\n"
        "          disparityctl process drives/*.mkv -o out --keep-going --resume --shard 0/8\n"
        "          disparityctl process long.mkv -o out --no-trust --no-adaptive-noise --resume --split --shard 0/8\n"
        "          disparityctl process drives/*.mkv --plan\n"
        "          disparityctl process walk.mkv -o out --scan walk.csv --scan-set camera_height_m=0.4");
    command.callback([arguments, &action] { action = [arguments] { return process(*arguments); }; });
}

}  // namespace disparityd::tools
