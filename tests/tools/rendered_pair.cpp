// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/rendered_pair.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "calibration/rectification.h"
#include "capture/frame_source.h"
#include "kernels/large_buffer.h"
#include "kernels/matcher.h"
#include "kernels/parallel.h"

namespace disparityd::test {
namespace {

Plane<std::uint8_t> plane_of(cv::Mat& image) {
    return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step)};
}

void rectify(const RawImage& raw, RenderedPair& pair, cv::Size size) {
    const auto rectification = calibration::make_rectification(pair.calibration, size.width, size.height, {});
    const Rectifier rectifier = rectification.rectifier();
    const auto matcher = make_matcher("cpu", {size.width, size.height, default_options(Method::sad, {0, 16})});
    const LargeBuffer scratch(matcher->scratch_bytes());
    pair.left.create(size, CV_8UC1);
    pair.right.create(size, CV_8UC1);
    FrameView view;
    view.raw = raw;
    view.rectifier = &rectifier;
    view.left = plane_of(pair.left);
    view.right = plane_of(pair.right);
    view.scratch = {scratch.data(), scratch.size()};
    std::vector<std::chrono::nanoseconds> times(matcher->stages()[0].steps.size());
    Serial workers;
    matcher->run(0, view, workers, times);
}

}  // namespace

RenderedPair rendered_pair(unsigned seed, cv::Size size,
                           const std::function<void(calibration::StereoCalibration&)>& change) {
    capture::SourceOptions options;
    options.uri = "scene:vga?frames=1&seed=" + std::to_string(seed) + "&width=" + std::to_string(size.width) +
                  "&height=" + std::to_string(size.height);
    options.pace = capture::Pace::fastest;
    const auto source = capture::open_source(options);
    capture::RawFrame frame;
    if (source->next(frame, std::chrono::steady_clock::now() + std::chrono::minutes(1)) !=
        capture::FrameSource::Next::frame) {
        throw std::runtime_error("no frame was rendered");
    }
    RenderedPair pair;
    pair.calibration = source->info().calibration;
    if (change) {
        change(*pair.calibration);
    }
    rectify(frame.image, pair, size);
    source->give_back(frame);
    return pair;
}

}  // namespace disparityd::test
