// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/benchmark/result_files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include <opencv2/core.hpp>

#include "base/file_kind.h"
#include "base/message_text.h"
#include "base/words.h"
#include "capture/images/image_files.h"
#include "tools/images/disparity_file.h"
#include "tools/images/image_file.h"

namespace disparityd::eval {

namespace fs = std::filesystem;

namespace {

bool is_pattern(const std::string& where) {
    return where.find("{scene}") != std::string::npos || where.find("{frame}") != std::string::npos;
}

/// The parts of a scene's name; its folder is empty where the name has no slash.
struct SceneName {
    std::string folder;
    std::string frame;

    explicit SceneName(const std::string& scene) {
        const auto slash = scene.rfind('/');
        folder = slash == std::string::npos ? std::string() : scene.substr(0, slash);
        frame = slash == std::string::npos ? scene : scene.substr(slash + 1);
    }
};

std::string replaced(std::string text, const std::string& word, const std::string& by) {
    for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + by.size())) {
        text.replace(at, word.size(), by);
    }
    return text;
}

/// Adds SUBMISSION/disp0NAME.pfm of Middlebury, whose name the method chooses.
void add_named(const fs::path& folder, std::vector<fs::path>& stems) {
    std::vector<fs::path> found;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        const fs::path& path = entry->path();
        if (path.filename().string().starts_with("disp0") && path.extension() == ".pfm" && path.stem() != "disp0GT") {
            found.push_back(path.parent_path() / path.stem());
        }
    }
    std::sort(found.begin(), found.end());
    stems.insert(stems.end(), found.begin(), found.end());
}

/// Files that could be meant, without their endings.
std::vector<fs::path> stems_of(const fs::path& folder, const std::string& scene) {
    const SceneName name(scene);
    std::vector<fs::path> stems;
    for (const std::string& one : {scene, name.frame}) {
        stems.push_back(folder / one);
        stems.push_back(folder / one / "disp0");
        add_named(folder / one, stems);
    }
    stems.push_back(folder / replaced(scene, "/", "_"));
    stems.push_back(folder / "disp_0" / name.frame);
    stems.push_back(folder / "low_res_two_view" / name.frame);
    return stems;
}

std::string with_ending(const fs::path& stem) {
    for (const char* ending : {".pfm", ".png"}) {
        if (base::is_file(stem.string() + ending)) {
            return stem.string() + ending;
        }
    }
    return {};
}

[[noreturn]] void refuse_size(const std::string& path, int found_width, int found_height, int width, int height) {
    throw std::invalid_argument(path + ": found " + base::size_text(found_width, found_height) +
                                " px, allowed: " + base::size_text(width, height) + ", the size of the ground truth");
}

}  // namespace

ResultFiles parse_result_files(const std::string& option, const std::string& text) {
    ResultFiles files;
    const auto equals = text.find('=');
    const bool named =
        equals != std::string::npos && !base::is_folder(text) && text.substr(0, equals).find('/') == std::string::npos;
    files.where = named ? text.substr(equals + 1) : text;
    if (named) {
        files.matcher = text.substr(0, equals);
    } else {
        const fs::path path = fs::path(text).lexically_normal();
        files.matcher = (path.has_filename() ? path : path.parent_path()).filename().string();
    }
    if (files.matcher.empty() || files.where.empty()) {
        throw std::invalid_argument(option + ": found '" + base::printable(text) +
                                    "', allowed: NAME=WHERE or WHERE, a folder or a pattern with {scene} or {frame}");
    }
    if (!is_pattern(files.where) && !base::is_folder(files.where)) {
        throw std::invalid_argument(option + ": " + base::printable(files.where, 300) +
                                    ": is no folder and no pattern with {scene} or {frame}");
    }
    return files;
}

std::string find_result(const ResultFiles& files, const std::string& scene) {
    const SceneName name(scene);
    if (is_pattern(files.where)) {
        std::string path = files.where;
        if (name.folder.empty()) {
            path = replaced(path, "{folder}/", "");
        }
        path = replaced(replaced(replaced(path, "{folder}", name.folder), "{frame}", name.frame), "{scene}", scene);
        if (!base::is_file(path)) {
            throw std::invalid_argument(scene + ": " + files.matcher + " has no file " + base::printable(path, 300));
        }
        return path;
    }
    std::vector<std::string> found;
    for (const fs::path& stem : stems_of(files.where, scene)) {
        const std::string path = with_ending(stem);
        if (!path.empty() && std::find(found.begin(), found.end(), path) == found.end()) {
            found.push_back(path);
        }
    }
    if (found.empty()) {
        throw std::invalid_argument(scene + ": " + files.matcher + " has no file in " +
                                    base::printable(files.where, 300) + ", such as " + scene + ".pfm or " + name.frame +
                                    ".png");
    }
    if (found.size() > 1) {
        throw std::invalid_argument(scene + ": " + files.matcher + " has " + base::printable(found[0], 300) + " and " +
                                    base::printable(found[1], 300) + "; say which by a pattern, such as " +
                                    files.where + "/{scene}.pfm");
    }
    return found.front();
}

images::FloatMap read_result(const std::string& path, int width, int height) {
    images::check_ending(path, {".pfm", ".png"});
    images::FloatMap map =
        images::has_ending(path, ".pfm") ? images::read_disparity_pfm(path) : images::read_disparity_png(path);
    if (map.width != width || map.height != height) {
        refuse_size(path, map.width, map.height, width, height);
    }
    return map;
}

std::vector<float> read_confidence(const std::string& path, int width, int height) {
    std::vector<float> values;
    cv::Size size(width, height);
    if (images::has_ending(path, ".pfm")) {
        images::FloatMap map = images::read_disparity_pfm(path);
        size = {map.width, map.height};
        values = std::move(map.values);
    } else {
        cv::Mat image = capture::decode_image(path);
        if (image.channels() != 1 || (image.depth() != CV_8U && image.depth() != CV_16U)) {
            throw std::invalid_argument(path + ": found " + std::to_string(image.channels()) + " channels of " +
                                        std::to_string(image.elemSize1() * 8) +
                                        " bits; allowed: PFM, or a grey image of 8 or 16 bits");
        }
        size = image.size();
        image.convertTo(image, CV_32F);
        values.assign(image.begin<float>(), image.end<float>());
    }
    if (size != cv::Size(width, height)) {
        refuse_size(path, size.width, size.height, width, height);
    }
    if (!std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); })) {
        throw std::invalid_argument(path + ": found a confidence that is not finite; give 0 where there is none");
    }
    return values;
}

}  // namespace disparityd::eval
