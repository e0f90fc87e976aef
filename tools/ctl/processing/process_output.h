// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
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
#include "pipeline/worker_pool.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/growing_file.h"
#include "tools/ctl/processing/earlier_run.h"
#include "tools/ctl/processing/frame_writers.h"
#include "tools/ctl/processing/manifest.h"
#include "tools/ctl/processing/more_outputs.h"
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
    /// name whose files (NAME.png, NAME_colour.png ...) would be those of an earlier frame gets "-2", "-3" ... at its
    /// end.
    std::string next(std::string_view input);

private:
    std::uint64_t count_ = 0;
    std::set<std::string, std::less<>> taken_;
};

/// Whether a file lies in a folder itself. Neither need be there.
bool lies_in(const std::string& file, const std::string& folder);

/// Says which files `process` writes for a frame: at least one of png and pfm.
struct OutputFormats {
    bool png = true;
    bool pfm = false;
    bool colour = false;
    images::ColourRange colours = images::ColourRange::searched;
    MoreOutputs more = {};
};

/// How frames are counted in times.csv and corrections.csv, and whether the correction of the first is told where it is
/// that of the frame before.
enum class Numbers {
    of_run,    ///< from 0; it is told
    of_whole,  ///< a range of a whole that is joined afterwards: as in the whole
};

/// Locks a folder: only this process fills it while the object exists (base/file_lock.h). One thread uses it.
class FolderLock {
public:
    enum class Missing { make, leave };
    /// Throws std::runtime_error when another process fills it, or when it cannot be made.
    FolderLock(const std::string& folder, Missing missing);
    ~FolderLock();
    /// Waits until the disk has all that was written on its file system, so that what is written afterwards is not
    /// there without it after a power cut. Throws base::DiskFull or std::runtime_error when the system refuses.
    void sync(const std::string& folder) const;

    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int descriptor_ = -1;
};

/// The folder that `process` fills: NAME.png, NAME.pfm and NAME_colour.png per frame (FrameNames), times.csv with a
/// line per frame, geometry.json, corrections.csv where self-calibration changed something, and manifest.json when all
/// is done. Each appears by its name when it is whole. One thread uses it at a time; the files of several frames are
/// written at once, in threads of its own. Everything but times.csv depends on input and options alone.
class ProcessOutput {
public:
    /// Throws std::invalid_argument when the folder holds anything but what may be replaced, or a finished run that is
    /// to stay, and std::runtime_error when another process fills it; changes nothing yet.
    static void check(const std::string& folder, Replacing replacing);

    /// Makes the folder; files of an earlier run in it are removed. Throws as check() does, also for a run that another
    /// process has finished meanwhile, and std::runtime_error when the system refuses. `workers` outlives it, and says
    /// how many frames are written at once.
    ProcessOutput(pipeline::WorkerPool& workers, std::string folder, Replacing replacing, OutputFormats formats,
                  const capture::SourceInfo& source, const MatchOptions& options,
                  const std::optional<ScanOptions>& scan, const std::string& backend,
                  const calibration::Rectification& rectification, const std::vector<std::string>& steps,
                  const Json& parameters, const std::string& scan_file, Numbers numbers);
    ~ProcessOutput();  ///< as close(), but for what the system refuses
    ProcessOutput(const ProcessOutput&) = delete;
    ProcessOutput& operator=(const ProcessOutput&) = delete;

    /// Says that the frames from here on are of another size: geometry.json then describes each part. Throws
    /// std::runtime_error when it cannot be written.
    void begin_part(const capture::SourceInfo& source, const calibration::Rectification& rectification);

    /// Counts a frame that is left out in front of the first one. Any thread, before that one is written.
    void skip(const capture::RawFrame& frame);

    /// Writes the files of one frame, or has begun to when it returns. Throws base::DiskFull or std::runtime_error when
    /// one of this frame or of an earlier one cannot be written; none is written afterwards.
    void write(const pipeline::FrameSlot& slot, const trust::Verdict& verdict);

    /// Waits until all files of the frames are written. Throws as write().
    void settle() { writers_.settle(); }

    /// Gives times.csv and corrections.csv their names, unless files of a frame could not be written. Throws as
    /// write().
    void close();

    /// Writes the manifest: all frames of the source are there. `scan` is the file of the obstacle scans, which is told
    /// where it lies in the folder; empty: none. `input` is what content_of_input() says, or null. Throws as write().
    void finish(const Json& losses, const std::string& scan, const Json& input);

    /// Whether it removed an earlier run that was not finished.
    bool replaces_unfinished() const { return replaces_unfinished_; }

    /// How many frames it was given.
    std::uint64_t frames() const { return frames_; }

    /// Of how many all files are written. All that it was given, after settle() without a failure.
    std::uint64_t written() const { return written_; }

private:
    std::string whole_folder() const;
    void write_times(const pipeline::FrameSlot& slot, const Json& frame);
    FrameView needed_planes(const FrameView& frame) const;
    Json write_planes(const FrameCopy& frame, const std::string& name) const;
    void note_correction(const pipeline::FrameSlot& slot);

    std::string folder_;
    Numbers numbers_;
    std::uint64_t skipped_ = 0;  ///< frames of the whole in front of the first one
    std::string source_name_;
    bool synthetic_;  ///< SourceInfo::synthetic
    FolderLock lock_;
    FrameNames names_;
    OutputFormats formats_;
    MatchOptions options_;
    Json parts_ = Json::array();     ///< source, rectified, distances of each
    std::vector<std::string> maps_;  ///< SHA-256 of each
    Json match_;
    Json scan_;               ///< null: no scan
    Json files_;              ///< of the manifest
    std::uint64_t lost_ = 0;  ///< by source and pipeline
    bool replaces_unfinished_ = false;
    bool listed_only_ = false;  ///< the last line of times.csv is of a frame that nobody writes
    std::optional<GrowingFile> times_;
    std::optional<GrowingFile> corrections_;  // opened with the first of them
    std::optional<ManifestWriter> manifest_;
    calibration::CalibrationCorrection correction_;
    std::uint64_t frames_ = 0;
    std::uint64_t written_ = 0;
    FrameWriters writers_;  // last: its threads use the others
};

}  // namespace disparityd::tools
