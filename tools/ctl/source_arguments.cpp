// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/source_arguments.h"

#include <chrono>
#include <utility>

#include "capture/camera_calibration.h"
#include "capture/pixel_format.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/interrupt.h"
#include "tools/ctl/progress.h"
#include "tools/ctl/table.h"

namespace disparityd::tools {

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
    options.calibration_folders = capture::folder_list(capture::standard_calibration_folders);
    return capture::open_source(options);
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
                       std::string(capture::name(source.format));
    if (source.rate > 0) {
        text += ", " + fixed(source.rate, source.rate == static_cast<int>(source.rate) ? 0 : 2) + " frames/s";
    }
    if (source.frame_count) {
        text += ", " + std::to_string(*source.frame_count) + " frames";
    }
    text += source.live ? ", live" : "";
    if (!source.calibration) {
        return text + ", no calibration";
    }
    return text + ", calibration from " + source.calibration->origin +
           (source.calibration->rectified ? " (rectified already)" : "");
}

}  // namespace disparityd::tools
