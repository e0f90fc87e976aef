// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/source_arguments.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "base/words.h"
#include "calibration/calibration_lookup.h"
#include "capture/camera/camera_uri.h"
#include "capture/gstreamer/gst_uri.h"
#include "capture/pixel_format.h"
#include "capture/time_offset.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/describe.h"

namespace disparityd::tools {

namespace {

capture::SourceKind kind_of(const std::string& uri) {
    const auto& kinds = capture::source_kinds();
    const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& one) { return one.accepts(uri); });
    return kind == kinds.end() ? capture::SourceKind{} : *kind;
}

}  // namespace

bool is_kept(const std::string& uri) {
    return kind_of(uri).is_kept;
}

bool is_calibrated_elsewhere(const std::string& uri) {
    return kind_of(uri).calibrated_elsewhere;
}

std::unique_ptr<capture::FrameSource> open_with_progress(capture::SourceOptions options) {
    std::unique_ptr<Progress> bar;
    int bar_total = 0;
    options.progress = [&](int done, int total) {
        if (!bar || total != bar_total) {
            bar = std::make_unique<Progress>("preparing", static_cast<std::uint64_t>(total < 0 ? 0 : total));
            bar_total = total;
        }
        bar->show(static_cast<std::uint64_t>(done < 0 ? 0 : done));
    };
    const bool two_cameras =
        capture::is_camera(options.uri) && capture::parse_camera_uri(options.uri).right.has_value();
    if (!options.report && (capture::is_gst(options.uri) || is_kept(options.uri) || two_cameras)) {
        options.report = [](const std::string& line, bool) { print_note(line); };
    }
    options.calibration_folders = calibration::folder_list(calibration::standard_calibration_folders);
    const int asked_us = std::exchange(options.time_offset_us, 0);
    auto source = capture::open_source(options);
    const int contained_us = source->info().time_offset_us;
    if (asked_us == 0 || contained_us == asked_us) {
        return source;
    }
    if (contained_us != 0) {
        throw std::invalid_argument("--time-offset-us: found " + std::to_string(asked_us) + ", but the stamps of " +
                                    options.uri + " contain " + std::to_string(contained_us) +
                                    " us since they were recorded, allowed is " + std::to_string(contained_us));
    }
    options.time_offset_us = asked_us;
    return capture::with_time_offset(std::move(source), options);
}

void add_time_offset(CLI::App& command, std::optional<int>& offset_us, const std::string& when) {
    add_integer(
        command, "--time-offset-us", offset_us, -100'000, 100'000,
        when + "microseconds to add to the time stamps of all frames, as [source] time_offset_us of the daemon");
}

std::optional<capture::RawFrame> next_frame(capture::FrameSource& source) {
    using Next = capture::FrameSource::Next;
    while (!interrupted()) {
        capture::RawFrame frame;
        switch (source.next(frame, std::chrono::steady_clock::now() + std::chrono::milliseconds(100))) {
            case Next::timeout: continue;
            case Next::frame: return frame;
            case Next::end:
            case Next::interrupted: return std::nullopt;
        }
    }
    return std::nullopt;
}

std::string summary(const capture::SourceInfo& source) {
    std::string text = std::to_string(source.eye_width) + " x " + std::to_string(source.height) + " per eye, " +
                       std::string(capture::to_string(source.format));
    if (source.rate > 0) {
        text += ", " + fixed(source.rate, source.rate == static_cast<int>(source.rate) ? 0 : 2) + " frames/s";
    }
    if (source.frame_count) {
        text += ", " + base::counted(*source.frame_count, "frame");
    }
    text += source.live ? ", live" : "";
    if (!source.calibration) {
        return text + ", no calibration";
    }
    if (source.calibration->left.fx == 0) {
        return text + ", rectified already, no calibration: distances are not known";
    }
    return text + ", calibration from " + source.calibration->origin +
           (source.calibration->rectified ? " (rectified already)" : "");
}

}  // namespace disparityd::tools
