// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/images/colours.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <opencv2/imgproc.hpp>

#include "bridges/frames/planes.h"

namespace disparityd::web {
namespace {

using frames::disparity_px;
using frames::has_metres;
using frames::metres;

constexpr Colour rejected{0, 0, 0};

std::array<Colour, 256> make_turbo() {
    cv::Mat numbers(1, 256, CV_8UC1);
    for (int i = 0; i < 256; ++i) {
        numbers.at<std::uint8_t>(i) = static_cast<std::uint8_t>(i);
    }
    cv::Mat map;
    cv::applyColorMap(numbers, map, cv::COLORMAP_TURBO);
    std::array<Colour, 256> colours{};
    for (int i = 0; i < 256; ++i) {
        const auto& bgr = map.at<cv::Vec3b>(i);
        colours[static_cast<std::size_t>(i)] = {bgr[0], bgr[1], bgr[2]};
    }
    return colours;
}

const Colour& colour_at(double share) {
    const double clamped = std::isnan(share) ? 0 : std::clamp(share, 0.0, 1.0);
    return turbo()[static_cast<std::size_t>(std::lround(255 * clamped))];
}

}  // namespace

const std::array<Colour, 256>& turbo() {
    static const std::array<Colour, 256> colours = make_turbo();
    return colours;
}

DisparityColours::DisparityColours(const disparity::FrameInfo& frame, Image image, const std::optional<RangeM>& range)
    : invalid_(frame.invalid) {
    constexpr std::uint32_t most_disparities = 4096;  // as many as 16 bits hold in 1/16 px
    if (frame.disparities > most_disparities) {
        throw std::runtime_error("the frame says that it was searched for more disparities than there are");
    }
    constexpr double sixteenths = 16;
    double d_low = frame.d_min;
    double d_high = frame.d_min + static_cast<double>(frame.disparities);
    if (range && has_metres(frame)) {
        d_low = disparity_px(frame, range->far);
        d_high = disparity_px(frame, range->near);
    }
    near_m = metres(frame, d_high);
    far_m = metres(frame, d_low);
    if (image == Image::depth && near_m) {
        constexpr double depth_span = 8;
        far_m = std::min(far_m.value_or(INFINITY), range ? INFINITY : depth_span * *near_m);
        low = 1000 * *near_m;
        high = 1000 * *far_m;
    } else {
        low = sixteenths * d_low;
        high = sixteenths * d_high;
    }
    colours_.resize(std::size_t{16} * (frame.disparities + 1) + 1);
    fill(frame, image);
}

void DisparityColours::fill(const disparity::FrameInfo& frame, Image image) {
    for (std::size_t i = 1; i < colours_.size(); ++i) {
        const double d16 = static_cast<double>(i) + invalid_;
        if (image == Image::depth && has_metres(frame)) {
            const double mm = 1000 * metres(frame, d16 / 16).value_or(INFINITY);
            colours_[i] = colour_at((high - mm) / (high - low));
        } else {
            colours_[i] = colour_at((d16 - low) / (high - low));
        }
    }
    colours_[0] = rejected;
}

const Colour& DisparityColours::of(std::int16_t disparity16) const {
    const std::int64_t place = std::int64_t{disparity16} - invalid_;
    return colours_[static_cast<std::size_t>(
        std::clamp<std::int64_t>(place, 0, static_cast<std::int64_t>(colours_.size()) - 1))];
}

}  // namespace disparityd::web
