// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/process_output.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "tools/ctl/describe.h"
#include "tools/ctl/table.h"
#include "tools/images/disparity_file.h"
#include "tools/images/image_file.h"
#include "tools/images/picture.h"

namespace disparityd::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* times_name = "times.csv";
constexpr const char* geometry_name = "geometry.json";
constexpr const char* corrections_name = "corrections.csv";

/// Whether a file name is one that this class gives.
bool is_ours(const std::string& name) {
    if (name == times_name || name == geometry_name || name == corrections_name) {
        return true;
    }
    const auto digits_end =
        std::find_if(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) == 0; });
    const std::string rest(digits_end, name.end());
    return digits_end - name.begin() >= 6 && (rest == ".png" || rest == ".pfm" || rest == "_colour.png");
}

[[noreturn]] void refuse(const std::string& folder, const std::error_code& error) {
    throw std::runtime_error(folder + ": " + error.message());
}

// A stream that has failed: streams tell no reason, but leave the system's.
[[noreturn]] void refuse_file(const std::string& folder, const char* name) {
    const int reason = errno;
    throw std::runtime_error(folder + '/' + name + ": cannot be written" +
                             (reason == 0 ? "" : ": " + std::generic_category().message(reason)));
}

void make_room(const std::string& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) {
        refuse(folder, error);
    }
    std::vector<fs::path> earlier;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        if (is_ours(entry.path().filename().string())) {
            earlier.push_back(entry.path());
        }
    }
    for (const fs::path& path : earlier) {
        if (!error) {
            fs::remove(path, error);
        }
    }
    if (error) {
        refuse(folder, error);
    }
}

Json files_of(const OutputFormats& formats) {
    Json files = Json::array();
    if (formats.png) {
        files.push_back({{"name", "%06d.png"},
                         {"content", "16-bit PNG, disparity x 256 in px, valid values 1 .. 65535"},
                         {"scale", 256},
                         {"rejected", 0}});
    }
    if (formats.pfm) {
        files.push_back({{"name", "%06d.pfm"},
                         {"content", "PFM, disparity in px, bottom row first, little endian"},
                         {"scale", 1},
                         {"rejected", "inf"}});
    }
    if (formats.colour) {
        files.push_back({{"name", "%06d_colour.png"}, {"content", "left image, coloured disparity, scale"}});
    }
    files.push_back({{"name", times_name}, {"content", "time of each step per frame, microseconds"}});
    return files;
}

}  // namespace

void ProcessOutput::check(const std::string& folder, bool force) {
    std::error_code error;
    if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
        throw std::invalid_argument(folder + ": is a file, allowed: a new or empty folder");
    }
    const fs::directory_iterator first(folder, error);
    if (error || first == fs::directory_iterator()) {
        return;
    }
    // Other people's pictures have such names too, the input's for one.
    const bool earlier_run = fs::exists(fs::path(folder) / geometry_name, error);
    if (!force || !earlier_run) {
        throw std::invalid_argument(folder + ": is not empty (found " + first->path().filename().string() +
                                    "), allowed: a new or empty folder" +
                                    (earlier_run ? ", or --force to replace the files of the earlier run in it" : ""));
    }
}

ProcessOutput::ProcessOutput(std::string folder, OutputFormats formats, const capture::SourceInfo& source,
                             const MatchOptions& options, const std::string& backend,
                             const capture::Rectification& rectification, const std::vector<std::string>& steps)
    : folder_(std::move(folder)), formats_(formats), options_(options) {
    make_room(folder_);
    Json match = to_json(options);
    match["backend"] = backend;
    Json rectified = to_json(rectification);
    rectified["invalid"] = invalid_disparity(options.range);
    const Json geometry{
        {"source", to_json(source)}, {"rectified", rectified}, {"match", match}, {"files", files_of(formats)}};
    const std::string text = to_text(geometry, 2) + '\n';
    images::write_file(folder_ + '/' + geometry_name,
                       {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});

    times_.open(folder_ + '/' + times_name, std::ios::binary);
    times_ << "frame,sequence,monotonic_ns,flags,dropped_before";
    for (const std::string& step : steps) {
        times_ << ',' << step << "_us";
    }
    times_ << ",total_us\n";
}

void ProcessOutput::write(const pipeline::FrameSlot& slot) {
    char number[32];
    std::snprintf(number, sizeof number, "/%06llu", static_cast<unsigned long long>(frames_));
    const std::string path = folder_ + number;
    const images::DisparityMap map{slot.view.disparity, options_.range};
    if (formats_.png) {
        images::write_disparity_png(path + ".png", map);
    }
    if (formats_.pfm) {
        images::write_disparity_pfm(path + ".pfm", map);
    }
    if (formats_.colour) {
        const capture::Rectification& used = *slot.rectification;
        const images::Metric metric{used.f, used.baseline_mm, used.disparity_offset};
        const cv::Mat left =
            slot.view.left_colour ? images::colour_view(slot.view.left_colour) : images::grey_view(slot.view.left);
        images::write_png(path + "_colour.png",
                          images::picture(left, map, images::whole_range(options_.range), metric));
    }
    write_times(slot);
    note_correction(slot);
    ++frames_;
}

void ProcessOutput::note_correction(const pipeline::FrameSlot& slot) {
    const capture::CalibrationCorrection& correction = slot.raw.correction;
    if (correction == correction_) {
        return;
    }
    correction_ = correction;
    if (!corrections_.is_open()) {
        corrections_.open(folder_ + '/' + corrections_name, std::ios::binary);
        corrections_.precision(17);
        corrections_ << "from_frame,from_sequence,pitch_nrad,yaw_nrad,roll_nrad,focal_ppb,f,cx,cy,baseline_mm,"
                        "calibration_id\n";
    }
    const capture::Rectification& used = *slot.rectification;
    corrections_ << frames_ << ',' << slot.raw.sequence << ',' << correction.pitch_nrad << ',' << correction.yaw_nrad
                 << ',' << correction.roll_nrad << ',' << correction.focal_ppb << ',' << used.f << ',' << used.cx << ','
                 << used.cy << ',' << used.baseline_mm << ',' << hexadecimal(used.calibration_id) << '\n';
    if (!corrections_.flush()) {
        refuse_file(folder_, corrections_name);
    }
}

void ProcessOutput::write_times(const pipeline::FrameSlot& slot) {
    times_ << frames_ << ',' << slot.raw.sequence << ',' << slot.raw.monotonic_ns << ',' << slot.raw.flags << ','
           << slot.dropped_before;
    std::chrono::nanoseconds total{0};
    for (const std::chrono::nanoseconds time : slot.step_times) {
        total += time;
        times_ << ',' << fixed(static_cast<double>(time.count()) / 1e3, 1);
    }
    times_ << ',' << fixed(static_cast<double>(total.count()) / 1e3, 1) << '\n';
    if (!times_) {
        refuse_file(folder_, times_name);
    }
}

void ProcessOutput::close() {
    times_.close();
    if (!times_) {
        refuse_file(folder_, times_name);
    }
}

}  // namespace disparityd::tools
