// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/process_report.h"

#include <iostream>
#include <utility>

#include "base/words.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/program.h"
#include "tools/command_line/table.h"
#include "tools/ctl/describe.h"

namespace disparityd::tools {
namespace {

using Estimates = std::vector<pipeline::CalibratingSchedule::Estimate>;

Json schedule_json(const Estimates& all) {
    Json estimates = Json::array();
    for (const auto& [sequence, result] : all) {
        const calibration::CalibrationCorrection& correction = result.correction;
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

void report_estimates(const Estimates& all) {
    for (const auto& [sequence, result] : all) {
        std::cout << "self-calibration, frame " << sequence << ": "
                  << (result.accepted ? "corrected" : "nothing changed") << ": " << result.reason << '\n';
    }
}

double rate(std::uint64_t frames, double seconds) {
    return seconds > 0 ? static_cast<double>(frames) / seconds : 0;
}

std::string in_time(std::uint64_t frames, double seconds) {
    return base::counted(frames, "frame") + " in " + fixed(seconds, 1) + " s, " + fixed(rate(frames, seconds), 1) +
           " frames/s";
}

Json summary_json(const ProcessDone& done) {
    const std::string& error = done.refusal.empty() ? done.error : done.refusal;
    Json json{{"folder", done.folder},
              {"frames", done.frames},
              {"damaged_frames_skipped", done.damaged},
              {"done_before", done.before},
              {"seconds", done.seconds},
              {"frames_per_second", rate(done.frames, done.seconds)},
              {"measured", done.measured ? Json(*done.measured) : Json()},
              {"trust", done.trust.as_json()},
              {"distances", done.range ? to_json(*done.range) : Json()},
              {"complete", error.empty() && done.left_out.empty() && !interrupted()},
              {"left_out", done.left_out},
              {"error", error}};
    if (done.estimates) {
        json["self_calibration"] = schedule_json(*done.estimates);
    }
    return json;
}

void print_summary(const ProcessDone& done) {
    if (done.before) {
        std::cout << done.folder << ": " << base::counted(done.frames, "frame") << ", done before\n";
        return;
    }
    if (done.estimates) {
        report_estimates(*done.estimates);
    }
    for (const std::string& line : done.distances) {
        std::cout << line << '\n';
    }
    if (const std::string trust = done.trust.text(); !trust.empty()) {
        std::cout << trust << '\n';
    }
    std::cout << done.folder << ": " << in_time(done.frames, done.seconds) << '\n';
}

int interrupted_status() {
    // A scheduler ends what is to be done later by SIGTERM; who presses Ctrl-C wants no more of it.
    return interrupted_by() == "Ctrl-C" ? exit_interrupted : exit_again;
}

/// Tells what went wrong; returns the exit status.
int tell_trouble(const ProcessDone& done) {
    const std::string in_folder = " in " + done.folder + ": " + base::counted(done.frames, "frame");
    if (!done.refusal.empty()) {
        print_error(done.refusal);
        return done.status;
    }
    if (!done.empty_note.empty()) {
        print_note(done.source + ": " + done.empty_note);
    }
    if (done.damaged > 0) {
        print_note("left out because they are marked as damaged: " + base::counted(done.damaged, "frame") + " of " +
                   done.source);
    }
    if (!done.error.empty()) {
        print_error(done.error + "; what came before that is" + in_folder);
        return done.again ? exit_again : exit_failed;
    }
    if (interrupted()) {
        print_note("stopped by " + interrupted_by() + "; what came before that is" + in_folder);
        return interrupted_status();
    }
    if (!done.left_out.empty()) {
        print_error(std::to_string(done.left_out.size()) + (done.left_out.size() == 1 ? " frame was" : " frames were") +
                    " left out, as noted above;" + in_folder);
        return exit_failed;
    }
    if (done.frames == 0) {
        print_error(done.source + ": there is no frame in it");
        return exit_failed;
    }
    return exit_done;
}

}  // namespace

int report_process(const ProcessDone& done, bool json) {
    if (done.refusal.empty() && json) {
        // With the sums of a list: who reads it need not know whether there was more than one source.
        const int status = tell_trouble(done);
        const bool whole = status == exit_done;
        const bool failed = !whole && status != exit_again && status != exit_interrupted;
        Json summary = summary_json(done);
        summary["sources_done"] = whole ? 1 : 0;
        summary["sources_done_before"] = done.before ? 1 : 0;
        summary["sources_failed"] = failed ? 1 : 0;
        summary["sources_left"] = whole || failed ? 0 : 1;
        std::cout << to_text(summary, 2) << '\n';
        return status;
    }
    if (done.refusal.empty()) {
        print_summary(done);
    }
    return tell_trouble(done);
}

ListReport::ListReport(std::string folder, std::size_t sources, bool json)
    : folder_(std::move(folder)), sources_(sources), json_(json) {}

int ListReport::add(const ProcessDone& done) {
    ++tried_;
    frames_ += done.before ? 0 : done.frames;
    before_ += done.before ? 1U : 0U;
    seconds_ += done.seconds;
    if (json_) {
        Json one = summary_json(done);
        one["source"] = done.source;
        each_.push_back(std::move(one));
    } else if (done.refusal.empty() && !done.before) {
        std::cout << done.folder << ": " << in_time(done.frames, done.seconds) << std::endl;
    }
    const int status = tell_trouble(done);
    failed_ += status == exit_done || interrupted() ? 0U : 1U;
    // What may be tried again goes before what may not: the rest is not done yet.
    const bool stops = status == exit_again || status == exit_interrupted;
    if (stops || (status != exit_done && status_ == exit_done)) {
        status_ = status;
    }
    return status;
}

int ListReport::finish() {
    const std::size_t whole = tried_ - failed_ - (interrupted() && tried_ > 0 ? 1U : 0U);
    if (json_) {
        std::cout << to_text({{"folder", folder_},
                              {"frames", frames_},
                              {"seconds", seconds_},
                              {"frames_per_second", rate(frames_, seconds_)},
                              {"complete", whole == sources_},
                              {"sources_done", whole},
                              {"sources_done_before", before_},
                              {"sources_failed", failed_},
                              {"sources_left", sources_ - whole - failed_},
                              {"sources", each_}},
                             2)
                  << '\n';
    } else {
        std::cout << folder_ << ": " << whole << " of " << base::counted(sources_, "source")
                  << (before_ > 0 ? std::string(" (done before: ").append(std::to_string(before_)) + ")" : "") << ", "
                  << in_time(frames_, seconds_) << '\n';
    }
    const std::size_t left = sources_ - tried_;
    if (interrupted() && left > 0) {
        status_ = interrupted_status();  // the signal may have come between two sources
    }
    const bool stopped = status_ == exit_again || status_ == exit_interrupted;
    std::string line;
    if (failed_ > 0) {
        line = base::counted(failed_, "source") + " of " + std::to_string(sources_) + " failed, as told above";
    }
    if (left > 0) {
        line += line.empty() ? "" : ", ";
        line += std::to_string(left);
        line += left == 1 ? " was" : " were";
        line += stopped ? " not begun; --resume goes on" : " not begun; --keep-going goes on with the next ones";
    }
    if (failed_ > 0) {
        print_error(line);
    } else if (!line.empty()) {
        print_note(line);
    }
    return status_;
}

}  // namespace disparityd::tools
