// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/conditions/frame_conditions.h"

#include <algorithm>
#include <vector>

#include "capture/images/image_decoders.h"
#include "tools/images/image_file.h"

namespace disparityd::eval {
namespace {

double sign(Draws& draws) {
    return draws.whole(0, 1) == 0 ? -1 : 1;
}

void tear(cv::Mat& image, const cv::Mat& before, int from_row) {
    const cv::Rect old(0, from_row, image.cols, image.rows - from_row);
    before(old).copyTo(image(old));
}

int drawn_row(const cv::Mat& image, Draws& draws) {
    return draws.whole(image.rows / 4, image.rows * 3 / 4);
}

/// A block of the frame before, from a place that is a little off.
void lose_block(cv::Mat& image, const cv::Mat& before, const cv::Rect& block, cv::Point off) {
    const cv::Point from(std::clamp(block.x + off.x, 0, image.cols - block.width),
                         std::clamp(block.y + off.y, 0, image.rows - block.height));
    before(cv::Rect(from, block.size())).copyTo(image(block));
}

}  // namespace

EyeError lift_rows(double rows, Draws& draws) {
    EyeError error;
    error.rows = rows * sign(draws);
    return error;
}

EyeError change_focal(double per_cent, Draws& draws) {
    EyeError error;
    error.focal = 1 + per_cent / 100 * sign(draws);
    return error;
}

EyeError look_later(double degrees, Draws& draws) {
    EyeError error;
    error.yaw_deg = degrees * sign(draws);
    // A robot that turns 40 degrees in a second goes half a metre in it.
    error.ahead_m = degrees / 40 * 0.5 * sign(draws);
    return error;
}

void compress(EyePair& images, double quality, Draws& /*draws*/) {
    for (cv::Mat& image : images) {
        const std::string bytes = images::jpeg_of(image, static_cast<int>(quality));
        image = capture::decode_jpeg({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, "a frame");
    }
}

void tear_one(EyePair& images, const EyePair& before, Draws& draws) {
    const auto eye = static_cast<std::size_t>(draws.whole(0, 1));
    tear(images[eye], before[eye], drawn_row(images[eye], draws));
}

void tear_both(EyePair& images, const EyePair& before, Draws& draws) {
    const int row = drawn_row(images[0], draws);
    tear(images[0], before[0], row);
    tear(images[1], before[1], row);
}

void lose_blocks(EyePair& images, const EyePair& before, Draws& draws) {
    constexpr int side = 64;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        cv::Mat& image = images[eye];
        const int across = (image.cols + side - 1) / side;
        const int blocks = across * ((image.rows + side - 1) / side);
        for (int run = draws.whole(2, 4); run > 0; --run) {
            const int first = draws.whole(0, blocks - 1);
            const int last = std::min(first + draws.whole(3, 12), blocks - 1);
            const cv::Point off{draws.whole(-4, 4), draws.whole(-2, 2)};
            for (int i = first; i <= last; ++i) {
                const cv::Rect block(i % across * side, i / across * side, side, side);
                lose_block(image, before[eye], block & cv::Rect(0, 0, image.cols, image.rows), off);
            }
        }
    }
}

}  // namespace disparityd::eval
