// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/failure_text.h"
#include "base/words.h"
#include "base/write_failure.h"
#include "pipeline/rectification_schedule.h"
#include "pipeline/worker_pool.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/program.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/mcap/frame_export.h"
#include "tools/ctl/mcap/mcap_report.h"
#include "tools/ctl/mcap/raw_pair.h"
#include "tools/ctl/output_file.h"
#include "tools/ctl/processing/frame_chain.h"
#include "tools/ctl/processing/input_files.h"
#include "tools/ctl/processing/matching_options.h"
#include "tools/ctl/processing/part_source.h"
#include "tools/ctl/source_arguments.h"

namespace disparityd::tools {
namespace {

/// What is written unless the command line says otherwise.
constexpr const char* usual_parts = "raw,disparity,depth,imu,tf";

struct ExportArguments {
    ProcessArguments process;
    std::string file;
    std::string contents;  ///< empty: the usual ones
    std::string camera = "stereo";
    bool scan_is_set = false;              ///< --scan-set is given
    std::vector<std::string> of_matching;  ///< options that are given and only matching uses
};

/// Returns what is asked for. Throws as parse_mcap_parts().
McapParts asked_parts(const ExportArguments& arguments) {
    return parse_mcap_parts(arguments.contents.empty() ? usual_parts : arguments.contents);
}

/// Returns what of the parts can be written of a source. What was not asked for by name is left out with a note.
McapParts possible_parts(const ExportArguments& arguments, const capture::SourceInfo& source) {
    McapParts parts = asked_parts(arguments);
    const auto& calibration = source.calibration;
    if (calibration && (!calibration->rectified || gives_distances(*calibration))) {
        return parts;
    }
    for (const McapPart part : {McapPart::depth, McapPart::depth_mm, McapPart::points, McapPart::scan}) {
        if (parts.erase(part) > 0) {
            const std::string why = arguments.process.source + " has no calibration, so no distance is known";
            if (!arguments.contents.empty()) {
                throw std::invalid_argument("--contents " + word_of(part) + ": " + why +
                                            "; give one with --calibration");
            }
            print_note(word_of(part) + " is left out: " + why);
        }
    }
    return parts;
}

void check_arguments(const ExportArguments& arguments) {
    check(arguments.process);
    check_camera_name(arguments.camera);
    const McapParts parts = asked_parts(arguments);
    if (parts.contains(McapPart::raw) && parts.contains(McapPart::rectified) &&
        (!arguments.process.size.empty() || !arguments.process.region.empty())) {
        throw std::invalid_argument(
            "--contents: found raw and rectified with --size or --region, allowed: one of both, as the camera_info of "
            "an eye describes one size");
    }
    if (!needs_matching(parts) && !arguments.of_matching.empty()) {
        throw std::invalid_argument(arguments.of_matching.front() +
                                    ": is given with --contents that are written without matching, allowed: without "
                                    "it, or with what is matched, such as disparity");
    }
    if (arguments.scan_is_set && !parts.contains(McapPart::scan)) {
        throw std::invalid_argument("--scan-set: is given without --contents scan, which it is for");
    }
    refuse_file_of_source(arguments.file, arguments.process.source);
    check_output(arguments.file, arguments.process.force);
}

std::unique_ptr<capture::FrameSource> open_whole(const ExportArguments& arguments, int loans) {
    const std::vector<capture::RunOfOneGeometry> parts = parts_of(arguments.process);
    if (parts.size() > 1) {
        throw std::invalid_argument(arguments.process.source +
                                    ": has images of several sizes or calibrations, allowed: those of one camera");
    }
    auto source = open_part(arguments.process, parts.front(), {0, frames_of(arguments.process), {}}, loans,
                            [](const std::string& line, bool) { print_note(line); });
    if (source->info().live && !source->info().frame_count) {
        print_note(arguments.process.source + " has no end: Ctrl-C stops, or use --frames");
    }
    return source;
}

/// Writes frames as they were captured, in the caller's thread. Returns why the source ended early; empty: it did not.
std::string copy_frames(FrameExport& to, capture::FrameSource& source, bool with_corrections) {
    Progress bar("frames", source.info().frame_count);
    for (;;) {
        std::optional<capture::RawFrame> frame;
        try {
            frame = next_frame(source);
            if (frame && !with_corrections) {
                frame->correction = {};
            }
            if (frame) {
                pipeline::check_recorded_correction(*frame);  // here, as what came before can be ended well
            }
        } catch (const std::exception& error) {
            return base::failure_text(error);
        }
        if (!frame) {
            return {};
        }
        to.write_raw(*frame);
        source.give_back(*frame);
        bar.show(to.frames());
    }
}

/// Matches the frames and writes what is made of them. Returns why the source ended early; empty: it did not.
std::string match_frames(FrameExport& to, const ExportArguments& arguments, const ExportPlan& plan,
                         capture::FrameSource& source, const MatchOptions& options) {
    const auto wants = [&to](disparity::Product product) {
        return std::find(to.products().begin(), to.products().end(), product) != to.products().end();
    };
    pipeline::PipelineConfig config;
    config.policy = pipeline::Policy::replay;
    config.left_colour = wants(disparity::Product::left_colour);
    config.right_colour = wants(disparity::Product::right_colour);
    config.depth = wants(disparity::Product::depth);
    pipeline::WorkerPool workers(arguments.process.workers.value_or(0));
    FrameChain chain(arguments.process, options, plan.scan, source, config, workers);
    check_metres(arguments.process, chain.rectification());
    if (chain.rectification().unrectified) {
        print_note(arguments.process.source + ": no calibration is known, frames are matched as they are");
    }
    std::exception_ptr not_written;
    pipeline::Pipeline& pipeline = chain.connect(
        [&](const pipeline::FrameSlot& slot) {
            try {
                to.write(slot, chain);
            } catch (...) {
                not_written = std::current_exception();
                throw;
            }
        },
        [&to](const capture::RawFrame& frame) { to.take_raw(frame); });
    Progress bar("frames", source.info().frame_count);
    run_to_end(pipeline, [&bar](const pipeline::PipelineStatus& now) {
        bar.show(now.published, fixed(now.rate, 1) + " frames/s");
    });
    for (const std::string& note : chain.notes()) {
        print_note(note);
    }
    const pipeline::PipelineStatus status = pipeline.status();
    if (status.damaged > 0) {
        print_note(base::counted(status.damaged, "damaged frame") + " left out");
    }
    if (not_written) {
        std::rethrow_exception(not_written);  // the file cannot be gone on with
    }
    return status.error;
}

int export_source(const ExportArguments& arguments) {
    catch_interrupts();
    check_arguments(arguments);
    constexpr int loans = 6;  // those of the pipeline's slots, and two on their way
    const auto source = open_whole(arguments, loans);
    const McapParts parts = possible_parts(arguments, source->info());
    const MatchOptions options = match_options(arguments.process);
    ExportPlan plan;
    plan.file = arguments.file;
    plan.existing =
        arguments.process.force ? formats::McapFile::Existing::replaced : formats::McapFile::Existing::refused;
    plan.camera = arguments.camera;
    plan.parts = parts;
    plan.range = options.range;
    plan.interpolated = options.post.interpolate;
    if (parts.contains(McapPart::scan)) {
        plan.scan =
            arguments.process.scan_options.options(options.method == Method::sgm && options.sgm.calibrated_confidence);
    }
    FrameExport to(plan, source->info());
    McapReport report{.file = arguments.file};
    try {
        report.error = needs_matching(parts) ? match_frames(to, arguments, plan, *source, options)
                                             : copy_frames(to, *source, !arguments.process.no_self_calibration);
        to.finish();
    } catch (const base::DiskFull& error) {
        report.error = error.what();
        report.disk_full = true;
    } catch (const std::invalid_argument&) {
        throw;
    } catch (const std::exception& error) {
        report.error = base::failure_text(error);
    }
    report.take(to.file());
    return report.tell(arguments.process.json);
}

/// Adds the options of matching. Returns those that nothing but matching uses.
std::vector<CLI::Option*> add_options_of_matching(CLI::App& command, ProcessArguments& process) {
    const std::vector<CLI::Option*> before = command.get_options();
    add_matching_options(command, process);
    std::vector<CLI::Option*> added = command.get_options();
    const auto is_for_all = [&](CLI::Option* option) {
        const std::string name = option->get_name();
        return std::find(before.begin(), before.end(), option) != before.end() || name == "--calibration" ||
               name == "--frames" || name == "--time-offset-us" || name == "--no-self-calibration";
    };
    added.erase(std::remove_if(added.begin(), added.end(), is_for_all), added.end());
    return added;
}

}  // namespace

void add_export(CLI::App& program, Action& action) {
    CLI::App& command =
        *program.add_subcommand("export", "Write a source and what is made of it as messages of ROS 2, offline.");
    const auto arguments = std::make_shared<ExportArguments>();
    ProcessArguments& process = arguments->process;
    command
        .add_option("SOURCE", process.source,
                    "a recording, a bag, a folder, scene:... with --frames; see disparityctl sources")
        ->required();
    command.add_option("--mcap", arguments->file, "the file to make, in the format MCAP")
        ->type_name("FILE")
        ->required();
    command
        .add_option("--contents", arguments->contents,
                    "what the file has, with commas between: " + mcap_parts_help() + "; default " + usual_parts)
        ->type_name("WORDS");
    command
        .add_option("--camera-name", arguments->camera, "topics are below /NAME, frames of reference begin with NAME_")
        ->type_name("NAME")
        ->capture_default_str();
    const std::vector<CLI::Option*> of_matching = add_options_of_matching(command, process);
    CLI::Option* const scan_set = process.scan_options.add_to(command);
    command.add_flag("--keep-going", process.keep_going, "leave damaged images of a folder out");
    command.add_flag("--force", process.force, "replace FILE when it exists");
    command.add_flag("--json", process.json, "a summary as one JSON object");
    command.footer(
        "FILE grows under its own name: whatever ends the program or the computer, all but the last second or so can\n"
        "be read. Stamps, and the times of messages in the file, are those of the source; the same source and options\n"
        "give the same bytes. raw, imu, sensors and tf alone are written without matching, whose options are refused\n"
        "then. Topics and frames of reference are those of disparity-ros2; raw images are left/image_raw and\n"
        "right/image_raw, or image_rect where the source is rectified. Exit status as that of process.\n"
        "Examples: disparityctl export walk.mkv --mcap walk.mcap\n"
        "          disparityctl export walk.mkv --mcap walk.mcap --contents raw,imu,tf\n"
        "          disparityctl export walk.mkv --mcap walk.mcap --contents rectified,depth,points,scan,tf "
        "--scan-set camera_height_m=0.4");
    command.callback([arguments, scan_set, of_matching, &action] {
        arguments->scan_is_set = scan_set->count() > 0;
        for (const CLI::Option* option : of_matching) {
            if (option->count() > 0) {
                arguments->of_matching.push_back(option->get_name());
            }
        }
        action = [arguments] { return export_source(*arguments); };
    });
}

}  // namespace disparityd::tools
