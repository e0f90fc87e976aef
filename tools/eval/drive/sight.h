// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "clients/cpp/disparity_client.hpp"
#include "kernels/matcher.h"
#include "kernels/stage_notes.h"
#include "obstacles/scan_stage.h"
#include "tools/eval/drive/robot.h"
#include "tools/eval/scan/course.h"

namespace disparityd::eval {

/// What a client of the daemon gets of a frame.
struct Seen {
    disparity::Scan scan;
    std::uint32_t flags = 0;  ///< disparity::FrameFlags, and the trust in the frame
};

/// Returns what a robot sees at a pose; called once for each frame, in their order.
using Sight = std::function<Seen(const Pose&)>;

/// Returns the camera of a robot that stands at a pose.
CourseCamera camera_at(CourseCamera camera, const Pose& pose);

/// Makes the scans of a drive: one scanner for all its frames, whose records are read as a client reads them.
class DriveScanner {
public:
    /// `notes`, where trust is told, are shared with its stage.
    DriveScanner(const CourseCamera& camera, DisparityRange range, const ScanOptions& options,
                 std::shared_ptr<StageNotes> notes = nullptr);

    /// `view` has disparities and confidences, and what the near guard has found where it is on.
    disparity::Scan scan(FrameView view, Parallel& workers);

private:
    CourseCamera camera_;
    ScanStage stage_;
    std::vector<std::byte> record_;
};

}  // namespace disparityd::eval
