// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/rectification.h"
#include "capture/frame_source.h"
#include "kernels/options.h"
#include "obstacles/scan_options.h"
#include "pipeline/frame_slot.h"
#include "tools/ctl/describe.h"
#include "tools/images/picture.h"
#include "trust/judge.h"

namespace disparityd::tools {

/// Returns a text as a name that any file system takes: at most 200 bytes, "_" for a slash and control characters.
std::string file_name(std::string_view input, bool without_ending);

/// Names the files of each frame: the name of the input without its ending ("000012_10" of 000012_10.png), or the
/// frame's number in six digits where frames have no name. The same frames in the same order get the same names.
class FrameNames {
public:
    /// Returns the name for the next frame. `input` is the name of its file, without a folder; empty = it has none. A
    /// name whose files (NAME.png, NAME_colour.png) would be those of an earlier frame gets "-2", "-3" ... at its end.
    std::string next(std::string_view input);

private:
    std::uint64_t count_ = 0;
    std::set<std::string, std::less<>> taken_;
};

/// Says which files `process` writes for a frame: at least one of png and pfm.
struct OutputFormats {
    bool png = true;
    bool pfm = false;
    bool colour = false;
    images::ColourRange colours = images::ColourRange::searched;
};

/// Locks a folder: only this process fills it while the object exists (base/file_lock.h). One thread uses it.
class FolderLock {
public:
    enum class Missing { make, leave };
    /// Throws std::runtime_error when another process fills it, or when it cannot be made.
    FolderLock(const std::string& folder, Missing missing);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int descriptor_ = -1;
};

/// The folder that `process` fills: NAME.png, NAME.pfm and NAME_colour.png per frame (frame_names.h), times.csv with a
/// line per frame, geometry.json, and corrections.csv where self-calibration changed something. One thread uses it at a
/// time. Everything but times.csv depends on input and options alone.
class ProcessOutput {
public:
    /// Throws std::invalid_argument when the folder holds anything, but for an earlier run with `force`, and
    /// std::runtime_error when another process fills it; changes nothing yet.
    static void check(const std::string& folder, bool force);

    /// Makes the folder; files of an earlier run in it are removed. Throws as check() does, and std::runtime_error when
    /// the system refuses.
    ProcessOutput(std::string folder, bool force, OutputFormats formats, const capture::SourceInfo& source,
                  const MatchOptions& options, const std::optional<ScanOptions>& scan, const std::string& backend,
                  const calibration::Rectification& rectification, const std::vector<std::string>& steps);

    /// Says that the frames from here on are of another size: geometry.json then describes each part. Throws
    /// std::runtime_error when it cannot be written.
    void begin_part(const capture::SourceInfo& source, const calibration::Rectification& rectification);

    /// Writes the files of one frame. Throws std::runtime_error when one cannot be written.
    void write(const pipeline::FrameSlot& slot, const trust::Verdict& verdict);

    /// Throws std::runtime_error when the last lines of times.csv cannot be written.
    void close();

    std::uint64_t frames() const { return frames_; }

private:
    void write_times(const pipeline::FrameSlot& slot, const trust::Verdict& verdict, const std::string& name);
    void note_correction(const pipeline::FrameSlot& slot);

    std::string folder_;
    std::string source_name_;
    bool synthetic_;  ///< SourceInfo::synthetic
    FolderLock lock_;
    FrameNames names_;
    OutputFormats formats_;
    MatchOptions options_;
    Json parts_ = Json::array();  ///< source, rectified, distances of each
    Json match_;
    Json scan_;  ///< null: no scan
    std::ofstream times_;
    std::ofstream corrections_;  // opened with the first of them
    calibration::CalibrationCorrection correction_;
    std::uint64_t frames_ = 0;
};

}  // namespace disparityd::tools
