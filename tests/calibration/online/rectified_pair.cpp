// SPDX-License-Identifier: Apache-2.0
#include "tests/calibration/online/rectified_pair.h"

#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "capture/frame_source.h"
#include "kernels/reference/steps.h"

namespace disparityd::calibration::test {

Pair rectified(const RawImage& raw, const StereoCalibration& calibration, const RectifiedGeometry& geometry) {
    Pair pair;
    pair.used = make_rectification(calibration, raw.eye_width, raw.height, geometry);
    const Rectifier rectifier = pair.used.rectifier();
    for (const auto& [eye, image] : {std::pair(Eye::left, &pair.left), std::pair(Eye::right, &pair.right)}) {
        *image = {pair.used.width, pair.used.height, {}};
        image->pixels.resize(static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height));
        reference::rectify(raw, eye, rectifier, image->plane(), {0, image->height});
    }
    return pair;
}

SceneFrames::SceneFrames(const std::string& uri) {
    capture::SourceOptions options;
    options.uri = uri;
    options.pace = capture::Pace::fastest;
    const auto source = capture::open_source(options);
    width_ = source->info().eye_width;
    height_ = source->info().height;
    capture::RawFrame frame;
    for (;;) {
        switch (source->next(frame, std::chrono::steady_clock::now() + std::chrono::minutes(1))) {
            case capture::FrameSource::Next::frame: break;
            case capture::FrameSource::Next::end: return;
            default: throw std::runtime_error("the scene does not go on");
        }
        const auto bytes = static_cast<std::size_t>(frame.image.stride) * static_cast<std::size_t>(height_);
        frames_.emplace_back(frame.image.data, frame.image.data + bytes);
        source->give_back(frame);
    }
}

RawImage SceneFrames::frame(int index) const {
    return {frames_.at(static_cast<std::size_t>(index)).data(), PixelFormat::yuyv, width_, height_,
            4 * static_cast<std::ptrdiff_t>(width_)};
}

std::int32_t nrad(double degrees) {
    return static_cast<std::int32_t>(std::lround(degrees * std::numbers::pi / 180 * 1e9));
}

}  // namespace disparityd::calibration::test
