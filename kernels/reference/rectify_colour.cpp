// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "kernels/reference/bilinear.h"
#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

struct Bgr {
    int b = 0;
    int g = 0;
    int r = 0;
};

// ITU-R BT.601, studio range, 20 fraction bits.
Bgr from_yuv(int y, int u, int v) {
    const int luma = std::max(y - 16, 0) * 1220542 + (1 << 19);
    const auto channel = [luma](int chroma) { return std::clamp((luma + chroma) >> 20, 0, 255); };
    return {channel(2116026 * (u - 128)), channel(-852492 * (v - 128) - 409993 * (u - 128)),
            channel(1673527 * (v - 128))};
}

template <PixelFormat format>
Bgr colour(const std::uint8_t* row, int x) {
    if constexpr (format == PixelFormat::grey8) {
        return {row[x], row[x], row[x]};
    } else if constexpr (format == PixelFormat::yuyv) {
        const std::uint8_t* pair = row + 4 * (x / 2);
        return from_yuv(row[2 * x], pair[1], pair[3]);
    } else {
        return {row[3 * x], row[3 * x + 1], row[3 * x + 2]};
    }
}

template <PixelFormat format>
void rectify_from(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> bgr, Rows rows) {
    const Plane<const std::uint8_t> source = raw.eye(eye);
    const RectifyMap& map = eye == Eye::left ? rectifier.left : rectifier.right;
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < bgr.width / 3; ++x) {
            std::uint8_t* out = &bgr.at(3 * x, y);
            if (rectifier.mapped) {
                Bgr sum;
                bilinear(map, x, y, raw.eye_width, source.height, [&](int px, int py, int weight) {
                    const Bgr pixel = colour<format>(source.row(py), px);
                    sum.b += weight * pixel.b;
                    sum.g += weight * pixel.g;
                    sum.r += weight * pixel.r;
                });
                out[0] = round_bilinear(sum.b);
                out[1] = round_bilinear(sum.g);
                out[2] = round_bilinear(sum.r);
            } else {
                const Bgr pixel = colour<format>(source.row(rectifier.crop_y + y), rectifier.crop_x + x);
                out[0] = static_cast<std::uint8_t>(pixel.b);
                out[1] = static_cast<std::uint8_t>(pixel.g);
                out[2] = static_cast<std::uint8_t>(pixel.r);
            }
        }
    }
}

}  // namespace

void rectify_colour(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> bgr, Rows rows) {
    switch (raw.format) {
        case PixelFormat::grey8: rectify_from<PixelFormat::grey8>(raw, eye, rectifier, bgr, rows); break;
        case PixelFormat::yuyv: rectify_from<PixelFormat::yuyv>(raw, eye, rectifier, bgr, rows); break;
        case PixelFormat::bgr24: rectify_from<PixelFormat::bgr24>(raw, eye, rectifier, bgr, rows); break;
    }
}

}  // namespace disparityd::reference
