// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "calibration/rectification.h"
#include "kernels/options.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/processing/frame_copy.h"

namespace disparityd::tools {

/// What `process` writes of a frame beside disparities and their picture, where it is asked for.
struct MoreOutputs {
    bool depth = false;
    bool depth_error = false;
    bool confidence = false;
    bool rectified = false;
    std::string points;  ///< "ply", "pcd"; empty: none

    /// Whether any of it is in metres, which takes a calibration.
    bool metric() const { return depth || depth_error || !points.empty(); }
};

/// What may stand between a frame's name and ".png".
constexpr std::string_view output_suffixes[] = {"_colour", "_depth", "_depth_error", "_confidence", "_left", "_right"};

/// Writes them as PATH_depth.png and so on, and adds the SHA-256 of each to `digests`, by the names that begin with
/// `name`. Throws std::runtime_error when one cannot be written.
void write_more(const MoreOutputs& outputs, const FrameCopy& frame, DisparityRange range, const std::string& path,
                const std::string& name, Json& digests);

/// Adds what geometry.json says of them to its files.
void describe_more(const MoreOutputs& outputs, Json& files);

/// Returns a calib.txt as Middlebury has it for rectified pairs: K of both eyes, baseline in mm, size and range.
std::string middlebury_calibration(const calibration::Rectification& rectified, DisparityRange range);

}  // namespace disparityd::tools
