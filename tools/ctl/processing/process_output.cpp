// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/process_output.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "base/failure_text.h"
#include "base/file_lock.h"
#include "base/write_failure.h"
#include "proto/doubt.h"
#include "tools/command_line/table.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/processing/begun_run.h"
#include "tools/ctl/processing/digest.h"
#include "tools/ctl/processing/earlier_run.h"
#include "tools/ctl/processing/times_csv.h"
#include "tools/images/disparity_file.h"
#include "tools/images/image_file.h"
#include "tools/images/picture.h"

namespace disparityd::tools {
namespace {

/// File systems allow 255 bytes; an ending and a number follow the name.
constexpr std::size_t longest = 200;

}  // namespace

std::string file_name(std::string_view input, bool without_ending) {
    const std::size_t dot = without_ending ? input.rfind('.') : std::string_view::npos;
    std::string stem(dot == std::string_view::npos || dot == 0 ? input : input.substr(0, dot));
    if (stem.size() > longest) {
        std::size_t size = longest;
        while (size > 0 && (static_cast<unsigned char>(stem[size]) & 0xc0U) == 0x80U) {
            --size;  // not within a character of UTF-8
        }
        stem.resize(size);
    }
    std::replace_if(
        stem.begin(), stem.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f || c == '/'; }, '_');
    return stem;
}

namespace {

namespace fs = std::filesystem;

/// Returns the input of frames that have no name of their own.
std::string name_of_source(const std::string& uri) {
    return uri.substr(uri.rfind('/') + 1);
}

Json files_of(const OutputFormats& formats) {
    Json files = Json::array();
    if (formats.png) {
        files.push_back({{"name", "OUTPUT.png"},
                         {"content", "16-bit PNG, disparity x 256 in px, valid values 1 .. 65535"},
                         {"scale", 256},
                         {"rejected", 0}});
    }
    if (formats.pfm) {
        files.push_back({{"name", "OUTPUT.pfm"},
                         {"content", "PFM, disparity in px, bottom row first, little endian"},
                         {"scale", 1},
                         {"rejected", "inf"}});
    }
    if (formats.colour) {
        files.push_back({{"name", "OUTPUT_colour.png"}, {"content", "left image, coloured disparity, scale"}});
    }
    describe_more(formats.more, files);
    files.push_back(
        {{"name", times_name},
         {"content",
          "a line per frame: OUTPUT, the name of its input, trust in it, time of each step in microseconds"}});
    return files;
}

}  // namespace

std::string FrameNames::next(std::string_view input) {
    const std::uint64_t number = count_++;
    if (input.empty()) {
        char digits[32];
        std::snprintf(digits, sizeof digits, "%06llu", static_cast<unsigned long long>(number));
        return digits;
    }
    const std::string stem = file_name(input, true);
    std::string name = stem;
    const auto is_taken = [this, &name] {
        return taken_.contains(name) ||
               std::any_of(std::begin(output_suffixes), std::end(output_suffixes), [&](std::string_view suffix) {
                   return taken_.contains(name + std::string(suffix)) ||
                          (name.ends_with(suffix) && taken_.contains(name.substr(0, name.size() - suffix.size())));
               });
    };
    for (int i = 2; is_taken(); ++i) {
        name = stem + '-' + std::to_string(i);
    }
    taken_.insert(name);
    return name;
}

bool lies_in(const std::string& file, const std::string& folder) {
    return fs::absolute(file).lexically_normal().parent_path() ==
           (fs::absolute(folder) / "").lexically_normal().parent_path();
}

FolderLock::FolderLock(const std::string& folder, Missing missing) {
    if (missing == Missing::make) {
        std::error_code error;
        fs::create_directories(folder, error);
        if (error) {
            throw std::runtime_error(folder + ": " + base::error_text(error.value()));
        }
    }
    descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor_ < 0) {
        return;  // the next call that reads or writes in it reports why
    }
    try {
        base::lock_for_writing(descriptor_, folder);
    } catch (...) {
        ::close(descriptor_);
        throw;
    }
}

void FolderLock::sync(const std::string& folder) const {
    if (descriptor_ >= 0 && ::syncfs(descriptor_) != 0) {
        base::refuse_to_write(folder, errno);
    }
}

FolderLock::~FolderLock() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
    }
}

void ProcessOutput::check(const std::string& folder, Replacing replacing) {
    std::error_code error;
    if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
        throw std::invalid_argument(folder + ": is a file, allowed: a new or empty folder");
    }
    const FolderLock lock(folder, FolderLock::Missing::leave);
    check_content(folder, content_of(folder), replacing);
}

ProcessOutput::ProcessOutput(pipeline::WorkerPool& workers, std::string folder, Replacing replacing,
                             OutputFormats formats, const capture::SourceInfo& source, const MatchOptions& options,
                             const std::optional<ScanOptions>& scan, const std::string& backend,
                             const calibration::Rectification& rectification, const std::vector<std::string>& steps,
                             const Json& parameters, const std::string& scan_file, Numbers numbers)
    : folder_(std::move(folder)),
      numbers_(numbers),
      source_name_(name_of_source(source.name)),
      synthetic_(source.synthetic),
      lock_(folder_, FolderLock::Missing::make),
      formats_(formats),
      options_(options),
      writers_(
          workers, [this](const FrameCopy& frame, const std::string& name) { return write_planes(frame, name); },
          [this](Json frame, Json digests) {
              frame["sha256"] = std::move(digests);
              manifest_->add(frame);
              ++written_;
          }) {
    const FolderContent found = content_of(folder_);  // again: another run may have filled it meanwhile
    check_content(folder_, found, replacing);
    if (replacing == Replacing::unfinished) {
        check_begun_with(folder_, parameters);
        if (found.finished && is_done(folder_, scan_file, whole_folder())) {
            throw std::runtime_error(folder_ + ": another program has finished it meanwhile; run this again");
        }
    }
    replaces_unfinished_ = found.begun && replacing == Replacing::unfinished;
    remove_earlier_run(folder_);
    match_ = to_json(options);
    match_["backend"] = backend;
    if (scan) {
        scan_ = to_json(*scan);
    }
    manifest_.emplace(folder_, parameters);
    begin_part(source, rectification);
    times_.emplace(folder_ + '/' + times_name);
    std::string head = times_head();
    for (const std::string& step : steps) {
        head += step + "_us,";
    }
    times_->write(head + "total_us\n");
}

ProcessOutput::~ProcessOutput() {
    try {
        close();
    } catch (const std::exception&) {
        // What failed before is told already.
    }
}

void ProcessOutput::begin_part(const capture::SourceInfo& source, const calibration::Rectification& rectification) {
    Json rectified = to_json(rectification);
    rectified["invalid"] = invalid_disparity(options_.range);
    const auto distances = calibration::DepthRange::of(rectification.f, rectification.baseline_mm,
                                                       rectification.disparity_offset, options_);
    maps_.push_back(sha256(rectification));
    parts_.push_back({{"from_frame", frames_},
                      {"source", to_json(source)},
                      {"rectified", rectified},
                      {"distances", distances ? to_json(*distances) : Json()}});
    Json geometry;
    if (parts_.size() == 1) {
        geometry = {{"source", parts_[0]["source"]}, {"rectified", parts_[0]["rectified"]}, {"match", match_}};
    } else {
        // Whoever expects one geometry for all frames must not find one.
        geometry = {{"parts", parts_}, {"match", match_}};
    }
    if (!scan_.is_null()) {
        geometry["scan"] = scan_;
    }
    if (parts_.size() == 1) {
        geometry["distances"] = parts_[0]["distances"];
    }
    geometry["files"] = files_of(formats_);
    files_[geometry_name] = sha256_of_geometry(geometry);
    if (formats_.more.rectified && rectification.f > 0) {
        const std::string name =
            parts_.size() == 1 ? "calib.txt" : std::string("calib-").append(std::to_string(frames_)).append(".txt");
        const std::string calibration = middlebury_calibration(rectification, options_.range);
        images::write_file(folder_ + '/' + name, calibration);
        files_[name] = sha256(calibration);
    }
    images::write_file(folder_ + '/' + geometry_name, to_text(geometry, 2) + '\n');
}

/// Where a join may have moved the files of a range; empty: it is none.
std::string ProcessOutput::whole_folder() const {
    return numbers_ == Numbers::of_whole ? fs::path(folder_).parent_path().string() : std::string();
}

void ProcessOutput::skip(const capture::RawFrame& frame) {
    names_.next(frame.name);
    if (numbers_ == Numbers::of_whole) {
        ++skipped_;
        correction_ = frame.correction;
    }
}

FrameView ProcessOutput::needed_planes(const FrameView& frame) const {
    const MoreOutputs& more = formats_.more;
    FrameView needed;
    needed.disparity = frame.disparity;
    if (more.depth) {
        needed.depth = frame.depth;
    }
    if (more.depth_error) {
        needed.depth_error = frame.depth_error;
    }
    if (more.confidence) {
        needed.confidence = frame.confidence;
    }
    // Of an eye in colour nobody reads the grey image.
    if (formats_.colour || more.rectified || !more.points.empty()) {
        (frame.left_colour ? needed.left_colour : needed.left) = frame.left_colour ? frame.left_colour : frame.left;
    }
    if (more.rectified) {
        (frame.right_colour ? needed.right_colour : needed.right) =
            frame.right_colour ? frame.right_colour : frame.right;
    }
    return needed;
}

Json ProcessOutput::write_planes(const FrameCopy& frame, const std::string& name) const {
    const std::string path = folder_ + '/' + name;
    const FrameView& view = frame.view();
    const images::DisparityMap map{view.disparity, options_.range};
    Json digests;
    if (formats_.png) {
        const cv::Mat picture = images::disparity_picture(map);
        images::write_png(path + ".png", picture);
        digests[name + ".png"] = sha256(picture);
    }
    if (formats_.pfm) {
        const images::FloatMap values = images::to_float(map);
        images::write_disparity_pfm(path + ".pfm", values);
        digests[name + ".pfm"] = sha256(values);
    }
    if (formats_.colour) {
        const calibration::Rectification& used = frame.rectification();
        const images::Metric metric{used.f, used.baseline_mm, used.disparity_offset};
        const cv::Mat left = view.left_colour ? images::colour_view(view.left_colour) : images::grey_view(view.left);
        cv::Mat picture = images::picture(left, map, images::colour_scale(map, formats_.colours), metric);
        if (synthetic_) {
            images::mark_synthetic(picture);
        }
        images::write_png(path + "_colour.png", picture);
        digests[name + "_colour.png"] = sha256(picture);
    }
    write_more(formats_.more, frame, options_.range, path, name, digests);
    return digests;
}

void ProcessOutput::write(const pipeline::FrameSlot& slot, const trust::Verdict& verdict) {
    const std::string name = names_.next(slot.raw.name);
    Json frame{{"output", name},
               {"input", slot.raw.name.empty() ? std::string_view(source_name_) : slot.raw.name},
               {"sequence", slot.raw.sequence},
               {"monotonic_ns", slot.raw.monotonic_ns},
               {"flags", slot.raw.flags},
               {"dropped_before", slot.dropped_before},
               {"trust", unsigned{verdict.trust}},
               {"doubts", proto::doubt_names(verdict.doubts)}};
    // First: what is not listed is not removed when the run is killed and begins anew.
    listed_only_ = true;
    write_times(slot, frame);
    writers_.add(needed_planes(slot.view), slot.rectification, name, std::move(frame));
    lost_ += slot.dropped_before;
    note_correction(slot);
    listed_only_ = false;
    ++frames_;
}

void ProcessOutput::note_correction(const pipeline::FrameSlot& slot) {
    const calibration::CalibrationCorrection& correction = slot.raw.correction;
    if (correction == correction_) {
        return;
    }
    correction_ = correction;
    std::ostringstream line;
    line.precision(17);
    if (!corrections_) {
        corrections_.emplace(folder_ + '/' + corrections_name);
        line << "from_frame,from_sequence,pitch_nrad,yaw_nrad,roll_nrad,focal_ppb,f,cx,cy,baseline_mm,calibration_id\n";
    }
    const calibration::Rectification& used = *slot.rectification;
    line << skipped_ + frames_ << ',' << slot.raw.sequence << ',' << correction.pitch_nrad << ',' << correction.yaw_nrad
         << ',' << correction.roll_nrad << ',' << correction.focal_ppb << ',' << used.f << ',' << used.cx << ','
         << used.cy << ',' << used.baseline_mm << ',' << hexadecimal(used.calibration_id) << '\n';
    corrections_->write(line.str());
}

void ProcessOutput::write_times(const pipeline::FrameSlot& slot, const Json& frame) {
    std::string line = times_columns(skipped_ + frames_, frame);
    std::chrono::nanoseconds total{0};
    for (const std::chrono::nanoseconds time : slot.step_times) {
        total += time;
        line += fixed(static_cast<double>(time.count()) / 1e3, 1) + ',';
    }
    times_->write(line + fixed(static_cast<double>(total.count()) / 1e3, 1) + '\n');
    times_->flush();  // no file of a frame is there that this one does not name, also of a killed run
}

void ProcessOutput::close() {
    settle();
    for (std::optional<GrowingFile>* const file : {&times_, &corrections_}) {
        if (*file) {
            if (!listed_only_ && !writers_.any_left()) {
                (*file)->finish();
            }
            file->reset();
        }
    }
}

void ProcessOutput::finish(const Json& losses, const std::string& scan, const Json& input) {
    if (const std::string path = folder_ + '/' + corrections_name; fs::exists(path)) {
        files_[corrections_name] = sha256_of_file(path);
    }
    const Json scan_digest = fs::is_regular_file(scan) ? Json(sha256_of_file(scan)) : Json();
    if (!scan_digest.is_null() && lies_in(scan, folder_)) {
        files_[fs::path(scan).filename().string()] = scan_digest;
    }
    lock_.sync(folder_);  // once: each picture by itself would take as long as matching
    Json all = losses;
    all["lost"] = lost_;
    Json parts = parts_;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        parts[i]["maps_sha256"] = maps_[i].empty() ? Json() : Json(maps_[i]);
    }
    manifest_->finish(
        {{"parts", parts}, {"losses", all}, {"files", files_}, {"scan_sha256", scan_digest}, {"input_sha256", input}});
}

}  // namespace disparityd::tools
