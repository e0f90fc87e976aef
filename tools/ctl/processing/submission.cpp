// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/submission.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "base/failure_text.h"
#include "base/file_kind.h"
#include "base/words.h"
#include "tools/command_line/csv.h"
#include "tools/command_line/table.h"
#include "tools/ctl/processing/manifest.h"
#include "tools/ctl/processing/times_csv.h"
#include "tools/images/disparity_file.h"
#include "tools/images/fill_holes.h"
#include "tools/images/image_file.h"

namespace disparityd::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::pair<std::string_view, Benchmark> benchmarks[] = {{"kitti2012", Benchmark::kitti2012},
                                                                 {"kitti2015", Benchmark::kitti2015},
                                                                 {"middlebury", Benchmark::middlebury},
                                                                 {"eth3d", Benchmark::eth3d}};

/// A frame that `process` has written.
struct Result {
    std::string path;  ///< without its ending
    std::string name;
    double seconds = 0;
};

/// Reads the times of a source beside its manifest.
class FrameTimes {
public:
    explicit FrameTimes(const std::string& folder) : path_(folder + '/' + times_name), file_(path_) {
        std::string head;
        std::getline(file_, head);
    }

    /// Returns the sum of the steps of the next frame.
    double next_s() {
        std::string line;
        std::getline(file_, line);
        const auto fields = csv_fields(line);
        const double us = fields.empty() ? 0 : std::strtod(fields.back().c_str(), nullptr);
        if (us <= 0) {
            throw std::invalid_argument(path_ + ": is damaged; process the source again");
        }
        return us / 1e6;
    }

private:
    std::string path_;
    std::ifstream file_;
};

/// Returns the frames of a source. Throws where their pixels are not those of its images.
std::vector<Result> results_in(const ProcessDone& done) {
    FrameTimes times(done.folder);
    std::vector<Result> results;
    const Json manifest = read_manifest(done.folder, [&](const Json& frame) {
        const std::string name = frame.at("output").get<std::string>();
        results.push_back({done.folder + '/' + name, name, times.next_s()});
    });
    for (const Json& part : manifest["parts"]) {
        const Json &source = part.at("source"), &rectified = part.at("rectified");
        if (!part.value("maps_sha256", Json()).is_null() || source.at("eye_width") != rectified.at("width") ||
            source.at("height") != rectified.at("height")) {
            throw std::invalid_argument("--submission: " + done.source +
                                        ": its images were rectified, scaled or cut here, allowed: those of the "
                                        "benchmark as they are");
        }
    }
    return results;
}

images::FloatMap read_map(const Result& result) {
    return base::is_file(result.path + ".pfm") ? images::read_disparity_pfm(result.path + ".pfm")
                                               : images::read_disparity_png(result.path + ".png");
}

void make_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) {
        throw std::runtime_error(folder.string() + ": " + base::error_text(error.value()));
    }
}

/// Whether it is six digits, "_" and two digits.
bool is_kitti_frame(std::string_view name) {
    constexpr std::string_view form = "000000_10";
    return name.size() == form.size() &&
           std::equal(name.begin(), name.end(), form.begin(), [](unsigned char found, char wanted) {
               return wanted == '_' ? found == '_' : std::isdigit(found) != 0;
           });
}

std::string write_kitti(const Submission& submission, const ProcessDone& done, const std::vector<Result>& results) {
    const fs::path folder =
        fs::path(submission.folder) / (submission.benchmark == Benchmark::kitti2015 ? "disp_0" : "");
    std::size_t written = 0;
    for (const Result& result : results) {
        if (!is_kitti_frame(result.name) || !base::is_file(result.path + ".png")) {
            throw std::invalid_argument("--submission: " + result.path +
                                        ".png: is no frame of KITTI, allowed: names such as 000000_10, and "
                                        "disparities that a PNG can hold");
        }
        if (!result.name.ends_with("_10")) {
            continue;  // the second frame of a sequence, of which no disparity is asked for
        }
        std::ifstream file(result.path + ".png", std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        make_folder(folder);
        images::write_file((folder / (result.name + ".png")).string(), bytes);
        ++written;
    }
    if (written == 0) {
        throw std::invalid_argument("--submission: " + done.source + ": has no frame whose name ends in _10");
    }
    return folder.string() + ": " + base::counted(written, "result");
}

/// Returns the folder that the source names.
fs::path scene_of(const std::string& source) {
    const fs::path path = fs::absolute(source.substr(0, source.find('?'))).lexically_normal();
    return path.has_filename() ? path : path.parent_path();
}

/// Returns where the results of a scene lie in the folder to send, without their endings.
fs::path place_of(const Submission& submission, const fs::path& scene) {
    if (submission.benchmark == Benchmark::eth3d) {
        return fs::path("low_res_two_view") / scene.filename();
    }
    const std::string set = scene.parent_path().filename().string();
    const bool known_set = set.starts_with("training") || set.starts_with("test");
    return fs::path(known_set ? set : "") / scene.filename();
}

std::string write_scene(const Submission& submission, const ProcessDone& done, const std::vector<Result>& results) {
    const fs::path scene = scene_of(done.source);
    if (!base::is_folder(scene) || results.size() != 1) {
        throw std::invalid_argument("--submission: " + done.source + ": has " + base::counted(results.size(), "frame") +
                                    ", allowed: the folder of a scene, with one pair");
    }
    const Result& result = results.front();
    const images::FloatMap map = images::fill_all(read_map(result));
    if (!std::all_of(map.values.begin(), map.values.end(), [](float value) { return std::isfinite(value); })) {
        throw std::invalid_argument("--submission: " + done.source +
                                    ": nothing was measured, so that no hole can be "
                                    "filled; each pixel must have a disparity");
    }
    const fs::path place = fs::path(submission.folder) / place_of(submission, scene);
    const std::string seconds = fixed(result.seconds, 6);
    fs::path disparity, time;
    std::string text = seconds + '\n';
    if (submission.benchmark == Benchmark::middlebury) {
        disparity = place / ("disp0" + submission.method + ".pfm");
        time = place / ("time" + submission.method + ".txt");
    } else {
        disparity = place.string() + ".pfm";
        time = place.string() + ".txt";
        text.insert(0, "runtime ");
    }
    make_folder(disparity.parent_path());
    images::write_disparity_pfm(disparity.string(), map);
    images::write_file(time.string(), text);
    return disparity.string() + ": 1 result";
}

/// Throws where the results of two sources would have the same name.
void check_names(const Submission& submission, std::span<const std::string> sources) {
    if (!submission.dense()) {
        if (sources.size() > 1) {
            throw std::invalid_argument("--submission: found " + std::to_string(sources.size()) +
                                        " sources, whose frames may have the same names, allowed for KITTI: one, the "
                                        "folder of its testing set");
        }
        return;
    }
    std::map<fs::path, std::string> places;
    for (const std::string& source : sources) {
        const auto [place, is_new] = places.emplace(place_of(submission, scene_of(source)), source);
        if (!is_new) {
            throw std::invalid_argument("--submission: " + source + " and " + place->second +
                                        " are scenes of the same name, and the results of one would replace those of "
                                        "the other; allowed: one of them");
        }
    }
}

}  // namespace

Submission parse_submission(const std::string& text, const std::string& method, const std::string& output) {
    Submission submission;
    const std::size_t equals = text.find('=');
    const std::string_view word = std::string_view(text).substr(0, equals);
    const auto* const found = std::find_if(std::begin(benchmarks), std::end(benchmarks),
                                           [word](const auto& benchmark) { return benchmark.first == word; });
    if (found == std::end(benchmarks) || equals == std::string::npos || equals + 1 == text.size()) {
        throw std::invalid_argument("--submission: found '" + text +
                                    "', allowed: kitti2012=FOLDER, kitti2015=FOLDER, middlebury=FOLDER or "
                                    "eth3d=FOLDER");
    }
    submission.benchmark = found->second;
    submission.folder = text.substr(equals + 1);
    submission.method = method;
    const bool good = !method.empty() && std::all_of(method.begin(), method.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '+';
    });
    // Middlebury has sparse results under names that end in it.
    if (!good || method.ends_with("_s")) {
        throw std::invalid_argument("--submission-name: found '" + method +
                                    "', allowed: letters, digits, _, - and +, without _s at the end");
    }
    const auto normal = [](const std::string& path) { return (fs::absolute(path) / "").lexically_normal().string(); };
    if (!output.empty() && normal(submission.folder).starts_with(normal(output))) {
        throw std::invalid_argument("--submission: " + submission.folder + ": lies in " + output +
                                    ", allowed: a folder beside it");
    }
    return submission;
}

void check_submission(const Submission& submission, std::span<const std::string> sources, bool may_hold_some) {
    check_names(submission, sources);
    std::error_code none;
    if (fs::exists(submission.folder, none) && !base::is_folder(submission.folder)) {
        throw std::invalid_argument("--submission: " + submission.folder +
                                    ": is a file, allowed: a new or empty folder");
    }
    if (!may_hold_some && base::is_folder(submission.folder) && !fs::is_empty(submission.folder, none)) {
        throw std::invalid_argument("--submission: " + submission.folder +
                                    ": is not empty, allowed: a new or empty folder, or --resume or --force, which "
                                    "replace what has the same name");
    }
}

std::string write_submission(const Submission& submission, const ProcessDone& done) {
    const std::vector<Result> results = results_in(done);
    return submission.dense() ? write_scene(submission, done, results) : write_kitti(submission, done, results);
}

}  // namespace disparityd::tools
