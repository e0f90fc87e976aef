// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/stereo_pair.h"

#include <array>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <stdexcept>

#include "base/words.h"
#include "calibration/rectification.h"
#include "capture/scene/scene_camera.h"
#include "capture/scene/scene_render.h"
#include "kernels/reference/steps.h"
#include "tools/command_line/program.h"
#include "tools/eval/opencv_matcher.h"
#include "tools/eval/paper.h"
#include "tools/eval/scene.h"

namespace disparityd::bench {
namespace {

constexpr int min_width = 16, min_height = 8, most = 4096;

std::vector<PairRequest> paper_pairs() {
    std::vector<PairRequest> pairs;
    for (const eval::PaperScene& scene : eval::paper_scenes()) {
        pairs.push_back({base::lower_case(scene.name), 0, 0, scene.disparities});
    }
    return pairs;
}

std::vector<PairRequest> rendered_pairs() {
    std::vector<PairRequest> pairs;
    for (const auto& [width, height, disparities] : {std::array{450, 375, 64},
                                                     {450, 375, 128},
                                                     {640, 480, 64},
                                                     {640, 480, 128},
                                                     {1280, 720, 128},
                                                     {1920, 1080, 128}}) {
        pairs.push_back({"rendered", width, height, disparities});
    }
    return pairs;
}

/// "450x375x128"; empty for any other text.
std::optional<PairRequest> parse_size(const std::string& text) {
    std::array<int, 3> numbers{};
    const char* at = text.data();
    const char* end = text.data() + text.size();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const auto [next, error] = std::from_chars(at, end, numbers[i]);
        const bool last = i + 1 == numbers.size();
        if (error != std::errc() || (last ? next != end : next == end || *next != 'x')) {
            return std::nullopt;
        }
        at = next + (last ? 0 : 1);
    }
    const auto [width, height, disparities] = numbers;
    if (width < min_width || width > most || height < min_height || height > most || disparities < 16 ||
        disparities > 256 || disparities % 16 != 0) {
        return std::nullopt;
    }
    return PairRequest{"rendered", width, height, disparities};
}

std::vector<PairRequest> parse_pair(const std::string& word) {
    if (word == "paper") {
        return paper_pairs();
    }
    if (word == "rendered") {
        return rendered_pairs();
    }
    for (const PairRequest& pair : paper_pairs()) {
        if (word == pair.scene) {
            return {pair};
        }
    }
    if (const auto size = parse_size(word)) {
        return {*size};
    }
    throw std::invalid_argument("--pair: found '" + word +
                                "', allowed: paper, cones, tsukuba, teddy, sawtooth, rendered, or "
                                "WIDTHxHEIGHTxDISPARITIES such as 640x480x64 (16x8 to 4096x4096, 16 to 256 disparities "
                                "in steps of 16)");
}

cv::Mat rectified(const RawImage& raw, Eye eye, const Rectifier& rectifier) {
    cv::Mat image(raw.height, raw.eye_width, CV_8UC1);
    reference::rectify(raw, eye, rectifier, {image.data, image.cols, image.rows, image.cols}, {0, image.rows});
    return image;
}

}  // namespace

std::vector<PairRequest> parse_pairs(const std::vector<std::string>& words) {
    std::vector<PairRequest> pairs;
    for (const std::string& word : words) {
        const std::vector<PairRequest> some = parse_pair(word);
        pairs.insert(pairs.end(), some.begin(), some.end());
    }
    return pairs;
}

StereoPair render(int width, int height, int disparities) {
    capture::SceneOptions options;
    options.width = width + width % 2;  // captured as YUYV, in pairs of pixels
    options.height = height;
    options.loop = 1;
    const capture::SceneRenderer renderer(options);
    std::vector<std::uint8_t> yuyv(renderer.frame_bytes());
    renderer.render(0, yuyv.data(), [] {});
    const RawImage raw{yuyv.data(), PixelFormat::yuyv, options.width, height, 4 * std::ptrdiff_t{options.width}};
    const calibration::Rectification maps =
        calibration::make_rectification(capture::scene_calibration(options.width, height), options.width, height, {});
    const Rectifier rectifier = maps.rectifier();
    return {"rendered", rectified(raw, Eye::left, rectifier).colRange(0, width).clone(),
            rectified(raw, Eye::right, rectifier).colRange(0, width).clone(), disparities};
}

std::vector<datasets::DatasetScene> find_scenes(std::string folder) {
    if (const char* given = std::getenv("DISPARITYD_DATA"); folder.empty() && given != nullptr) {
        folder = given;
    }
    return folder.empty() ? std::vector<datasets::DatasetScene>{} : eval::find_scenes({folder});
}

bool available(const PairRequest& request, const std::vector<datasets::DatasetScene>& found) {
    if (request.rendered() || eval::files_of(*eval::paper_scene(request.scene), found) != nullptr) {
        return true;
    }
    tools::print_note(request.scene + " is skipped: " +
                      (found.empty() ? "no evaluation data, name its folder by --data or DISPARITYD_DATA"
                                     : "there is no folder of that name in the evaluation data"));
    return false;
}

StereoPair load(const PairRequest& request, const std::vector<datasets::DatasetScene>& found) {
    if (request.rendered()) {
        return render(request.width, request.height, request.disparities);
    }
    const datasets::DatasetScene* files = eval::files_of(*eval::paper_scene(request.scene), found);
    const eval::Scene scene = eval::read_scene(*files, 0);
    return {request.scene, eval::grey(scene.left), eval::grey(scene.right), request.disparities};
}

}  // namespace disparityd::bench
