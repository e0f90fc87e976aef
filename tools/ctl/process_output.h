// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "capture/frame_source.h"
#include "capture/rectification.h"
#include "kernels/options.h"
#include "pipeline/frame_slot.h"

namespace disparityd::tools {

/// Which files `process` makes of a frame. At least one of png and pfm.
struct OutputFormats {
    bool png = true;
    bool pfm = false;
    bool colour = false;
};

/// The folder that `process` fills: NNNNNN.png, NNNNNN.pfm and NNNNNN_colour.png per frame, times.csv with a line per
/// frame, geometry.json, and corrections.csv where self-calibration changed something. One thread uses it at a time.
/// Everything but times.csv depends on input and options alone.
class ProcessOutput {
public:
    /// Throws std::invalid_argument when the folder holds anything, but for an earlier run with `force`; changes
    /// nothing yet.
    static void check(const std::string& folder, bool force);

    /// Makes the folder; files of an earlier run in it are removed. Throws std::runtime_error when the system refuses.
    ProcessOutput(std::string folder, OutputFormats formats, const capture::SourceInfo& source,
                  const MatchOptions& options, const std::string& backend, const capture::Rectification& rectification,
                  const std::vector<std::string>& steps);

    /// Writes the files of one frame. Throws std::runtime_error when one cannot be written.
    void write(const pipeline::FrameSlot& slot);

    /// Throws std::runtime_error when the last lines of times.csv cannot be written.
    void close();

    std::uint64_t frames() const { return frames_; }

private:
    void write_times(const pipeline::FrameSlot& slot);
    void note_correction(const pipeline::FrameSlot& slot);

    std::string folder_;
    OutputFormats formats_;
    MatchOptions options_;
    std::ofstream times_;
    std::ofstream corrections_;  // opened with the first of them
    capture::CalibrationCorrection correction_;
    std::uint64_t frames_ = 0;
};

}  // namespace disparityd::tools
