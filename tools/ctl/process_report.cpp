// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/process_report.h"

#include <iostream>

#include "base/words.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/program.h"
#include "tools/command_line/table.h"
#include "tools/ctl/describe.h"

namespace disparityd::tools {
namespace {

Json schedule_json(const pipeline::CalibratingSchedule& calibrating) {
    Json estimates = Json::array();
    for (const auto& [sequence, result] : calibrating.estimates()) {
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

void report_estimates(const pipeline::CalibratingSchedule& calibrating) {
    for (const auto& [sequence, result] : calibrating.estimates()) {
        std::cout << "self-calibration, frame " << sequence << ": "
                  << (result.accepted ? "corrected" : "nothing changed") << ": " << result.reason << '\n';
    }
}

void print_summary(const ProcessDone& done, bool as_json) {
    const double rate = done.seconds > 0 ? static_cast<double>(done.frames) / done.seconds : 0;
    const pipeline::CalibratingSchedule* calibrating = done.calibrating;
    if (as_json) {
        Json json{{"folder", done.folder},
                  {"frames", done.frames},
                  {"damaged_frames_skipped", done.damaged},
                  {"seconds", done.seconds},
                  {"frames_per_second", rate},
                  {"measured", done.measured ? Json(*done.measured) : Json()},
                  {"trust", done.trust.as_json()},
                  {"distances", done.range ? to_json(*done.range) : Json()},
                  {"complete", done.error.empty() && done.left_out.empty() && !interrupted()},
                  {"left_out", done.left_out},
                  {"error", done.error}};
        if (calibrating != nullptr) {
            json["self_calibration"] = schedule_json(*calibrating);
        }
        std::cout << to_text(json, 2) << '\n';
        return;
    }
    if (calibrating != nullptr) {
        report_estimates(*calibrating);
    }
    for (const std::string& line : done.distances) {
        std::cout << line << '\n';
    }
    if (const std::string trust = done.trust.text(); !trust.empty()) {
        std::cout << trust << '\n';
    }
    std::cout << done.folder << ": " << base::counted(done.frames, "frame") << " in " << fixed(done.seconds, 1)
              << " s, " << fixed(rate, 1) << " frames/s\n";
}

}  // namespace

int report_process(const ProcessDone& done, bool json) {
    print_summary(done, json);
    const std::string in_folder = " in " + done.folder + ": " + base::counted(done.frames, "frame");
    if (!done.empty_note.empty()) {
        print_note(done.source + ": " + done.empty_note);
    }
    if (done.damaged > 0) {
        print_note("left out because they are marked as damaged: " + base::counted(done.damaged, "frame"));
    }
    if (!done.error.empty()) {
        print_error(done.error + "; what came before that is" + in_folder);
        return exit_failed;
    }
    if (interrupted()) {
        print_note("stopped by " + interrupted_by() + "; what came before that is" + in_folder);
        return exit_interrupted;
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

}  // namespace disparityd::tools
