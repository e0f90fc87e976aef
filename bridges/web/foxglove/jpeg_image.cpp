// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/jpeg_image.h"

#include <turbojpeg.h>

namespace disparityd::foxglove {

JpegImage::JpegImage(const disparity::PlaneData& plane, int quality) {
    const bool grey = plane.bytes_per_pixel == 1;
    tjhandle compressor = tjInitCompress();
    if (compressor == nullptr) {
        return;
    }
    const int failed =
        tjCompress2(compressor, plane.bytes.data(), static_cast<int>(plane.width), 0, static_cast<int>(plane.height),
                    grey ? TJPF_GRAY : TJPF_BGR, &data_, &size_, grey ? TJSAMP_GRAY : TJSAMP_420, quality, 0);
    if (failed != 0) {
        size_ = 0;
    }
    tjDestroy(compressor);
}

JpegImage::~JpegImage() {
    tjFree(data_);
}

}  // namespace disparityd::foxglove
