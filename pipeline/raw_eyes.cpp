// SPDX-License-Identifier: Apache-2.0
#include "pipeline/raw_eyes.h"

#include <algorithm>

#include "kernels/luma.h"

namespace disparityd::pipeline {
namespace {

template <PixelFormat format>
void luma_of_row(const std::uint8_t* from, int width, std::uint8_t* to) {
    for (int x = 0; x < width; ++x) {
        to[x] = static_cast<std::uint8_t>(luma_of<format>(from, x));
    }
}

void luma_of_row(PixelFormat format, const std::uint8_t* from, int width, std::uint8_t* to) {
    switch (format) {
        case PixelFormat::grey8: std::copy_n(from, width, to); return;
        case PixelFormat::yuyv: luma_of_row<PixelFormat::yuyv>(from, width, to); return;
        case PixelFormat::bgr24: luma_of_row<PixelFormat::bgr24>(from, width, to); return;
    }
}

}  // namespace

void copy_luma(const RawImage& image, const RawEyes& to) {
    for (const Eye which : {Eye::left, Eye::right}) {
        const Plane<const std::uint8_t> from = image.eye(which);
        const Plane<std::uint8_t>& plane = which == Eye::left ? to.left : to.right;
        for (int y = 0; y < plane.height; ++y) {
            luma_of_row(image.format, from.row(y), plane.width, plane.row(y));
        }
    }
}

}  // namespace disparityd::pipeline
