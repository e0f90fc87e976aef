// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/process_arguments.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <system_error>

#include "capture/images/mask_image.h"
#include "tools/command_line/program.h"
#include "tools/ctl/colour_argument.h"
#include "tools/ctl/output_file.h"
#include "tools/ctl/processing/begun_run.h"
#include "tools/ctl/processing/digest.h"
#include "tools/ctl/processing/input_files.h"
#include "tools/datasets/announced_range.h"
#include "tools/images/disparity_file.h"

namespace disparityd::tools {
namespace {

constexpr int candidates_step = 16, most_candidates = 256;

std::string candidates(int first, int count) {
    return std::to_string(first) + " to " + std::to_string(first + count - 1) + " px";
}

/// Returns how many candidates are searched where the command line says nothing: as many as the files of a dataset ask
/// for (tools/datasets/announced_range.h), else `usual`. A note tells of it, and of a range that does not reach as far
/// as these files say, unless it is to be silent. `calibration` is the file given instead of the source's own; empty:
/// none.
int dataset_disparities(const std::string& source, const std::string& calibration, const MatchArguments& match,
                        int usual, Notes notes) {
    if (notes == Notes::none && match.disparities()) {
        return usual;  // which nobody asks for
    }
    auto announced = datasets::range_of_images(source);
    if (!calibration.empty()) {
        const auto of_calibration = datasets::range_of_calibration(calibration);
        announced = of_calibration ? of_calibration : announced;
    }
    if (!announced) {
        return usual;
    }
    const int first = match.d_min();
    const double needed = std::ceil((std::floor(announced->largest) + 1 - first) / candidates_step) * candidates_step;
    const int taken = static_cast<int>(std::clamp(needed, double{candidates_step}, double{most_candidates}));
    if (notes == Notes::none) {
        return taken;
    }
    const int searched = match.disparities().value_or(taken);
    if (searched < needed) {
        print_note(announced->origin + ", more than is searched: " + candidates(first, searched) +
                   "; what is nearer is not measured" +
                   (match.disparities() && taken > searched ? "; --disparities " + std::to_string(taken) +
                                                                  (taken < needed ? " reaches farther" : " reaches it")
                                                            : ""));
    } else if (!match.disparities() && taken != usual) {
        print_note(announced->origin + ": " + candidates(first, taken) + " are searched");
    }
    return taken;
}

/// Parses whole numbers between separators, of which the last two are a width and a height. Throws
/// std::invalid_argument unless there are as many as wanted.
void parse_numbers(const std::string& option, const std::string& text, char separator, const char* form,
                   std::span<int* const> numbers) {
    const char* at = text.data();
    const char* const end = text.data() + text.size();
    bool good = true;
    for (std::size_t i = 0; i < numbers.size() && good; ++i) {
        const auto [stop, error] = std::from_chars(at, end, *numbers[i]);
        good = error == std::errc() && (i + 1 == numbers.size() ? stop == end : stop != end && *stop == separator);
        at = stop + 1;
    }
    good = good && std::all_of(numbers.end() - 2, numbers.end(), [](const int* side) { return *side >= 1; });
    if (!good) {
        throw std::invalid_argument(option + ": found '" + text + "', allowed: " + form);
    }
}

/// The folder of a file must be there, or be the one that is made.
void check_parent(const std::string& file, const std::string& folder) {
    namespace fs = std::filesystem;
    const fs::path parent = fs::absolute(file).lexically_normal().parent_path();
    std::error_code error;
    if (!fs::is_directory(parent, error) && !lies_in(file, folder)) {
        throw std::invalid_argument("--scan: " + file + ": there is no folder " + parent.string());
    }
}

}  // namespace

MatchOptions match_options(const ProcessArguments& arguments, Notes notes) {
    return arguments.match.options(parse_method(arguments.method),
                                   dataset_disparities(arguments.source, arguments.calibration, arguments.match,
                                                       ProcessArguments::default_disparities, notes));
}

Replacing replacing(const ProcessArguments& arguments) {
    if (arguments.resume) {
        return Replacing::unfinished;
    }
    return arguments.force ? Replacing::earlier_run : Replacing::nothing;
}

std::string whole_of(const ProcessArguments& arguments) {
    return arguments.whole_frames ? std::filesystem::path(arguments.folder).parent_path().string() : std::string();
}

void check(const ProcessArguments& arguments) {
    if (arguments.split && arguments.shard.empty() && !arguments.plan) {
        throw std::invalid_argument("--split: found no --shard, allowed: with --shard I/N, or with --plan");
    }
    const Method method = parse_method(arguments.method);
    arguments.match.check_used({method});
    backend(arguments.backend);  // refuses an unknown one
    const MatchOptions options = arguments.match.options(method, ProcessArguments::default_disparities);
    geometry_of(arguments);
    arguments.distances.limits();  // refuses those that leave nothing
    scan_options_of(arguments, options);
}

calibration::RectifiedGeometry geometry_of(const ProcessArguments& arguments) {
    calibration::RectifiedGeometry geometry;
    if (!arguments.size.empty()) {
        int* const numbers[] = {&geometry.width, &geometry.height};
        parse_numbers("--size", arguments.size, 'x', "WIDTHxHEIGHT such as 640x360", numbers);
    }
    if (!arguments.region.empty()) {
        auto& region = geometry.region;
        int* const numbers[] = {&region.x, &region.y, &region.width, &region.height};
        parse_numbers("--region", arguments.region, ',', "X,Y,WIDTH,HEIGHT such as 0,100,640,160", numbers);
    }
    return geometry;
}

std::vector<capture::RunOfOneGeometry> parts_of(const ProcessArguments& arguments) {
    std::vector<capture::RunOfOneGeometry> parts{{0, SIZE_MAX}};
    if (!arguments.keep_going && capture::is_image_sequence(arguments.source)) {
        parts = capture::runs_of_one_geometry(arguments.source, arguments.calibration.empty());
    }
    if (parts.size() > 1) {
        if (arguments.self_calibrate) {
            throw std::invalid_argument(
                "--self-calibrate: " + arguments.source +
                " has images of several sizes or calibrations, allowed: those of one camera and size");
        }
        if (arguments.first) {
            throw std::invalid_argument("--first: " + arguments.source +
                                        " has images of several sizes or calibrations, allowed: those of one");
        }
        if (arguments.temporal) {
            throw std::invalid_argument(
                "--temporal: " + arguments.source +
                " has images of several sizes or calibrations, allowed: frames of one camera, in their order");
        }
    }
    return parts;
}

OutputFormats formats_of(const ProcessArguments& arguments, DisparityRange range) {
    OutputFormats formats{true, arguments.pfm, arguments.colour, colour_range(arguments.colours), arguments.more};
    if (!images::fits_png(range)) {
        formats.png = false;
        formats.pfm = true;
        print_note("disparities " + std::to_string(range.first) + " .. " +
                   std::to_string(range.first + range.count - 1) +
                   " do not fit a 16-bit PNG of disparity x 256: writing PFM instead");
    }
    return formats;
}

std::optional<ScanOptions> scan_options_of(const ProcessArguments& arguments, const MatchOptions& match) {
    if (arguments.scan.empty()) {
        return std::nullopt;
    }
    return arguments.scan_options.options(match.method == Method::sgm && match.sgm.calibrated_confidence);
}

std::optional<ScanOptions> scan_of(const ProcessArguments& arguments, const MatchOptions& match) {
    if (!arguments.scan.empty()) {
        // The parameters of a begun run were compared, and name this file.
        check_absent(arguments.scan, arguments.force || (arguments.resume && begun_with(arguments.folder)));
        check_parent(arguments.scan, arguments.folder);
    }
    return scan_options_of(arguments, match);
}

Json parameters_of(const ProcessArguments& arguments, const MatchOptions& match,
                   const std::optional<ScanOptions>& scan) {
    const auto or_null = [](const auto& value) { return value ? Json(*value) : Json(); };
    const auto digest = [](const std::string& file) { return file.empty() ? Json() : Json(sha256_of_file(file)); };
    const std::filesystem::path scan_path(arguments.scan);
    const Json scan_file = arguments.scan.empty() ? Json()
                           : lies_in(arguments.scan, arguments.folder)
                               ? Json(scan_path.filename().string())
                               : Json(std::filesystem::absolute(scan_path).lexically_normal().string());
    const pipeline::DistanceLimits limits = arguments.distances.limits();
    const Json calibration =
        arguments.calibration.empty() ? Json() : Json(content_of_calibration(arguments.calibration));
    return {{"input", facts_of_input(arguments.source)},
            {"match", to_json(match)},
            {"calibration", calibration},
            {"size", arguments.size},
            {"region", arguments.region},
            {"first", arguments.first.value_or(0)},
            {"frames", or_null(arguments.frames)},
            {"trust", !arguments.no_trust},
            {"time_offset_us", arguments.time_offset_us.value_or(0)},
            {"temporal", arguments.temporal},
            {"self_calibrate", arguments.self_calibrate},
            {"no_self_calibration", arguments.no_self_calibration},
            {"mask_polygons", arguments.mask_polygons},
            {"mask_image", digest(arguments.mask_image)},
            {"min_distance_m", limits.min_m},
            {"max_distance_m", limits.max_m},
            {"pfm", arguments.pfm},
            {"depth", arguments.more.depth},
            {"depth_error", arguments.more.depth_error ? Json(subpixel_error_px(arguments)) : Json()},
            {"confidence", arguments.more.confidence},
            {"rectified", arguments.more.rectified},
            {"points", arguments.more.points},
            {"colour", arguments.colour ? Json(arguments.colours) : Json()},
            {"scan", scan ? to_json(*scan) : Json()},
            {"scan_file", scan_file}};
}

void check_metres(const ProcessArguments& arguments, const calibration::Rectification& rectification) {
    const pipeline::DistanceLimits limits = arguments.distances.limits();
    if ((arguments.scan.empty() && !limits.any() && !arguments.more.metric()) ||
        (rectification.f > 0 && rectification.baseline_mm > 0)) {
        return;
    }
    const std::string option = !arguments.scan.empty()          ? "--scan"
                               : arguments.more.depth           ? "--depth"
                               : arguments.more.depth_error     ? "--depth-error"
                               : !arguments.more.points.empty() ? "--points"
                               : limits.min_m > 0               ? DistanceLimitArguments::min_option
                                                                : DistanceLimitArguments::max_option;
    throw std::invalid_argument(option + ": " + arguments.source +
                                " has no calibration, so no distance is known; give one with --calibration");
}

double subpixel_error_px(const ProcessArguments& arguments) {
    return arguments.scan_options.options(true).subpixel_error_px;
}

ImageMask mask_of(const ProcessArguments& arguments, const calibration::Rectification& rectification) {
    const capture::MaskImage file =
        arguments.mask_image.empty() ? capture::MaskImage{} : capture::read_mask_image(arguments.mask_image);
    return {rectification.width, rectification.height, arguments.mask_polygons, file.plane(), arguments.mask_image};
}

}  // namespace disparityd::tools
