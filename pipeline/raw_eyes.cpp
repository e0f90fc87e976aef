// SPDX-License-Identifier: Apache-2.0
#include "pipeline/raw_eyes.h"

#include <algorithm>

namespace disparityd::pipeline {
namespace {

void luma_of_row(PixelFormat format, const std::uint8_t* from, int width, std::uint8_t* to) {
    switch (format) {
        case PixelFormat::grey8: std::copy_n(from, width, to); return;
        case PixelFormat::yuyv:
            for (int x = 0; x < width; ++x) {
                to[x] = from[2 * x];
            }
            return;
        case PixelFormat::bgr24:
            for (int x = 0; x < width; ++x) {
                const std::uint8_t* bgr = from + 3 * x;
                to[x] = static_cast<std::uint8_t>((3735 * bgr[0] + 19235 * bgr[1] + 9798 * bgr[2] + (1 << 14)) >> 15);
            }
            return;
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
