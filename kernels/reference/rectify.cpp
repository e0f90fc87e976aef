// SPDX-License-Identifier: Apache-2.0
#include "kernels/luma.h"
#include "kernels/reference/bilinear.h"
#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

template <PixelFormat format>
void rectify_from(Plane<const std::uint8_t> source, int source_width, const Rectifier& rectifier, const RectifyMap& map,
                  Plane<std::uint8_t> out, Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < out.width; ++x) {
            if (rectifier.mapped) {
                int sum = 0;
                bilinear(map, x, y, source_width, source.height,
                         [&](int px, int py, int weight) { sum += weight * luma_of<format>(source.row(py), px); });
                out.at(x, y) = round_bilinear(sum);
            } else {
                const std::uint8_t* row = source.row(rectifier.crop_y + y);
                out.at(x, y) = static_cast<std::uint8_t>(luma_of<format>(row, rectifier.crop_x + x));
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
