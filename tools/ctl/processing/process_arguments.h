// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibration/rectification.h"
#include "capture/images/image_sequence.h"
#include "kernels/options.h"
#include "obstacles/image_mask.h"
#include "obstacles/scan_options.h"
#include "tools/command_line/match_arguments.h"
#include "tools/command_line/scan_arguments.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/distance_limit_arguments.h"
#include "tools/ctl/processing/more_outputs.h"
#include "tools/ctl/processing/process_output.h"

namespace disparityd::tools {

/// What the command line asks `process` for.
struct ProcessArguments {
    std::vector<std::string> sources;  ///< as typed
    std::string list;                  ///< a file of more of them; empty: none
    std::string source;                ///< the one at hand
    std::string folder;                ///< that it fills
    std::string method = "sgm";
    std::string backend = "auto";
    std::string calibration;
    std::string size;
    std::string region;
    std::string colours;
    std::string scan;  ///< file of the obstacle scans; empty: none
    ScanArguments scan_options;
    std::vector<std::string> mask_polygons;
    std::string mask_image;  ///< a file; empty: none
    DistanceLimitArguments distances;
    MatchArguments match;
    static constexpr int default_disparities = 64;
    std::optional<int> workers;
    std::optional<int> first;
    std::optional<int> frames;
    std::optional<int> time_offset_us;
    std::string submission;  ///< BENCHMARK=FOLDER; empty: none
    std::string submission_name = "disparityd";
    std::string shard;                          ///< I/N; empty: all
    bool split = false;                         ///< a shard does a range of the frames of each source
    std::optional<std::uint64_t> whole_frames;  ///< of the source, where `first` and `frames` are such a range
    bool no_trust = false;
    bool temporal = false;
    bool self_calibrate = false;
    bool no_self_calibration = false;
    MoreOutputs more;
    bool pfm = false;
    bool colour = false;
    bool force = false;
    bool resume = false;
    bool keep_going = false;
    bool hash_inputs = false;
    bool plan = false;
    bool json = false;
};

// All throw std::invalid_argument with one line for what is not allowed.

/// Returns the options of matching: those given, and as many candidates as the files of a dataset ask for
/// (tools/datasets/announced_range.h) where the command line says nothing. Notes tell of it, if they may.
enum class Notes { printed, none };
MatchOptions match_options(const ProcessArguments& arguments, Notes notes = Notes::printed);

/// Returns what may be in the folder already.
Replacing replacing(const ProcessArguments& arguments);

/// Returns the folder of the source where that of the arguments is for a range of --split; empty: it is not.
std::string whole_of(const ProcessArguments& arguments);

/// Refuses what no source could be processed with, before any is opened.
void check(const ProcessArguments& arguments);

calibration::RectifiedGeometry geometry_of(const ProcessArguments& arguments);

/// Returns the parts to process one after the other: of images those that share size and calibration, of
/// anything else the whole.
std::vector<capture::RunOfOneGeometry> parts_of(const ProcessArguments& arguments);

OutputFormats formats_of(const ProcessArguments& arguments, DisparityRange range);

/// Returns the options of the scan; nothing where none is wanted.
std::optional<ScanOptions> scan_of(const ProcessArguments& arguments, const MatchOptions& match);

/// Returns the same without a look at the files.
std::optional<ScanOptions> scan_options_of(const ProcessArguments& arguments, const MatchOptions& match);

/// Returns everything that results depend on but the calibration that a source brings, for the manifest. Throws
/// std::invalid_argument when a file that is named cannot be read.
Json parameters_of(const ProcessArguments& arguments, const MatchOptions& match,
                   const std::optional<ScanOptions>& scan);

/// Refuses frames without a calibration where every sector would be unknown, or no limit of distance had an effect.
void check_metres(const ProcessArguments& arguments, const calibration::Rectification& rectification);

/// Returns one sigma of a disparity in px, from which the depth error follows.
double subpixel_error_px(const ProcessArguments& arguments);

ImageMask mask_of(const ProcessArguments& arguments, const calibration::Rectification& rectification);

}  // namespace disparityd::tools
