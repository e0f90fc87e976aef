// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/input_files.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <set>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include <sys/stat.h>

#include "base/file_kind.h"
#include "calibration/formats/calibration_name.h"
#include "capture/bag/bag_uri.h"
#include "capture/images/image_sequence.h"
#include "tools/ctl/processing/digest.h"
#include "tools/ctl/source_arguments.h"

namespace disparityd::tools {
namespace {

namespace fs = std::filesystem;

/// What is read of a source: paths, and what their list says besides.
struct Listing {
    std::set<std::string> paths;
    std::string more;
};

Listing of_images(const std::string& uri) {
    const capture::ImageSequence sequence = capture::find_images(capture::parse_image_uri(uri).path);
    Listing all{{sequence.inertial_calibration, sequence.inertial_list}, {}};
    if (!sequence.calibration.empty()) {
        for (const std::string& file : calibration::parse_calibration_name(sequence.calibration).files) {
            all.paths.insert(file);
        }
    }
    for (const auto& frame : sequence.frames) {
        all.paths.insert({frame.left, frame.right, frame.calibration});
        all.more += std::to_string(frame.time_ns) + '\n';
    }
    all.paths.erase("");
    return all;
}

Listing of_folder(const std::string& folder) {
    Listing all;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        if (base::is_file(entry.path())) {
            all.paths.insert(entry.path().string());
        }
    }
    return all;
}

/// A video, or one for each eye, with or without parameters behind it.
Listing of_videos(const std::string& uri) {
    const std::string path = base::is_file(uri) ? uri : uri.substr(0, uri.find('?'));
    const std::size_t comma = path.find(',');
    if (base::is_file(path) || comma == std::string::npos) {
        return {{path}, {}};
    }
    return {{path.substr(0, comma), path.substr(comma + 1)}, {}};
}

Listing listing_of(const std::string& uri) {
    if (capture::is_bag(uri)) {
        const std::string path = capture::parse_bag_uri(uri).path;
        return base::is_folder(path) ? of_folder(path) : Listing{{path}, {}};
    }
    return capture::is_image_sequence(uri) ? of_images(uri) : of_videos(uri);
}

}  // namespace

Json facts_of_input(const std::string& uri) {
    Json facts{{"source", uri}, {"files", Json()}, {"bytes", Json()}, {"listing", Json()}};
    if (!is_kept(uri)) {
        return facts;
    }
    const Listing listing = listing_of(uri);
    std::ostringstream lines;
    std::int64_t bytes = 0;
    for (const std::string& path : listing.paths) {
        struct stat file {};
        lines << path;
        if (::stat(path.c_str(), &file) == 0) {
            lines << ' ' << file.st_size << ' ' << file.st_mtim.tv_sec << ' ' << file.st_mtim.tv_nsec;
            bytes += file.st_size;
        }
        lines << '\n';
    }
    facts["files"] = listing.paths.size();
    facts["bytes"] = bytes;
    facts["listing"] = sha256(lines.str() + listing.more);
    return facts;
}

Json content_of_input(const std::string& uri, const std::function<bool()>& stop) {
    if (!is_kept(uri)) {
        return {};
    }
    std::string lines;
    for (const std::string& path : listing_of(uri).paths) {
        const std::string digest = sha256_of_file(path, stop);
        if (digest.empty()) {
            return {};
        }
        lines += digest + '\n';
    }
    return sha256(lines);
}

std::string content_of_calibration(const std::string& name) {
    const calibration::CalibrationName parsed = calibration::parse_calibration_name(name);
    const bool alone = parsed.files.size() == 1 && parsed.files[0] == name;
    std::string lines;
    for (const std::string& file : parsed.files) {
        lines += sha256_of_file(file) + (alone ? "" : "\n");
    }
    return alone ? lines
                 : sha256(lines + (base::is_file(name) ? "" : name.substr(std::min(name.rfind('?'), name.size()))));
}

void refuse_file_of_source(const std::string& file, const std::string& uri) {
    std::error_code not_there;
    if (!fs::exists(file, not_there) || !is_kept(uri)) {
        return;
    }
    const Listing listing = listing_of(uri);
    if (std::any_of(listing.paths.begin(), listing.paths.end(),
                    [&](const std::string& path) { return fs::equivalent(file, path, not_there); })) {
        throw std::invalid_argument(file + ": is the source itself or a part of it, allowed: another file");
    }
}

}  // namespace disparityd::tools
