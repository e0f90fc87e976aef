// SPDX-License-Identifier: Apache-2.0
#include "lab/jpeg-load/yuyv_jpeg.h"

#include <array>
#include <cstddef>
#include <memory>
#include <stdexcept>

#include <turbojpeg.h>

namespace disparityd::lab {
namespace {

struct EndTurbo {
    void operator()(void* handle) const { tjDestroy(handle); }
};

}  // namespace

std::vector<std::uint8_t> jpeg_of(const std::vector<std::uint8_t>& yuyv, int width, int height, int quality) {
    std::vector<std::uint8_t> luma, u, v;
    for (std::size_t i = 0; i < yuyv.size(); i += 4) {
        luma.insert(luma.end(), {yuyv[i], yuyv[i + 2]});
        u.push_back(yuyv[i + 1]);
        v.push_back(yuyv[i + 3]);
    }
    std::array<const unsigned char*, 3> planes{luma.data(), u.data(), v.data()};
    const std::unique_ptr<void, EndTurbo> encoder(tjInitCompress());
    unsigned char* jpeg = nullptr;
    unsigned long size = 0;
    if (tjCompressFromYUVPlanes(encoder.get(), planes.data(), width, nullptr, height, TJSAMP_422, &jpeg, &size, quality,
                                TJFLAG_ACCURATEDCT) != 0) {
        throw std::runtime_error(tjGetErrorStr2(encoder.get()));
    }
    std::vector<std::uint8_t> bytes(jpeg, jpeg + size);
    tjFree(jpeg);
    return bytes;
}

}  // namespace disparityd::lab
