// SPDX-License-Identifier: Apache-2.0
#include "kernels/reference/bilinear.h"
#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

template <PixelFormat format>
int luma(const std::uint8_t* row, int x) {
    if constexpr (format == PixelFormat::grey8) {
        return row[x];
    } else if constexpr (format == PixelFormat::yuyv) {
        return row[2 * x];
    } else {
        const std::uint8_t* bgr = row + 3 * x;
        return (3735 * bgr[0] + 19235 * bgr[1] + 9798 * bgr[2] + (1 << 14)) >> 15;
    }
}

template <PixelFormat format>
void rectify_from(Plane<const std::uint8_t> source, int source_width, const Rectifier& rectifier, const RectifyMap& map,
                  Plane<std::uint8_t> out, Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < out.width; ++x) {
            if (rectifier.mapped) {
                int sum = 0;
                bilinear(map, x, y, source_width, source.height,
                         [&](int px, int py, int weight) { sum += weight * luma<format>(source.row(py), px); });
                out.at(x, y) = round_bilinear(sum);
            } else {
                const std::uint8_t* row = source.row(rectifier.crop_y + y);
                out.at(x, y) = static_cast<std::uint8_t>(luma<format>(row, rectifier.crop_x + x));
            }
        }
    }
}

}  // namespace

void rectify(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> out, Rows rows) {
    const Plane<const std::uint8_t> source = raw.eye(eye);
    const RectifyMap& map = eye == Eye::left ? rectifier.left : rectifier.right;
    switch (raw.format) {
        case PixelFormat::grey8:
            rectify_from<PixelFormat::grey8>(source, raw.eye_width, rectifier, map, out, rows);
            break;
        case PixelFormat::yuyv:
            rectify_from<PixelFormat::yuyv>(source, raw.eye_width, rectifier, map, out, rows);
            break;
        case PixelFormat::bgr24:
            rectify_from<PixelFormat::bgr24>(source, raw.eye_width, rectifier, map, out, rows);
            break;
    }
}

}  // namespace disparityd::reference
