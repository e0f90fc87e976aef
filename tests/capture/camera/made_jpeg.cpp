// SPDX-License-Identifier: Apache-2.0
#include "tests/capture/camera/made_jpeg.h"

#include <array>
#include <memory>
#include <random>
#include <stdexcept>

#include <turbojpeg.h>

namespace disparityd::capture::test {
namespace {

struct EndTurbo {
    void operator()(void* handle) const { tjDestroy(handle); }
};
using Turbo = std::unique_ptr<void, EndTurbo>;

}  // namespace

Bytes made_jpeg(int width, int height, int subsampling, unsigned seed, int flags) {
    std::mt19937 random(seed);
    Bytes picture(static_cast<std::size_t>(width * height * 3));
    const std::size_t bar = 5 + random() % 20;
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const std::size_t x = i / 3 % static_cast<std::size_t>(width);
        picture[i] = static_cast<std::uint8_t>(60 + 90 * ((x / bar + i % 3) % 2) + random() % 30);
    }
    const Turbo encoder(tjInitCompress());
    unsigned char* jpeg = nullptr;
    unsigned long size = 0;
    if (tjCompress2(encoder.get(), picture.data(), width, 0, height, TJPF_RGB, &jpeg, &size, subsampling, 90,
                    flags | TJFLAG_ACCURATEDCT) != 0) {
        throw std::runtime_error(tjGetErrorStr2(encoder.get()));
    }
    Bytes bytes(jpeg, jpeg + size);
    tjFree(jpeg);
    return bytes;
}

Planes planes_of(const Bytes& jpeg, int width, int height) {
    const Turbo decoder(tjInitDecompress());
    const auto size = static_cast<unsigned long>(jpeg.size());
    int found_width = 0, found_height = 0, subsampling = 0, space = 0;
    Planes planes;
    if (tjDecompressHeader3(decoder.get(), jpeg.data(), size, &found_width, &found_height, &subsampling, &space) != 0 ||
        found_width != width || found_height != height || subsampling < 0) {
        return planes;
    }
    planes.luma.resize(tjPlaneSizeYUV(0, width, 0, height, subsampling));
    const bool colour = subsampling != TJSAMP_GRAY;
    planes.columns = colour ? tjPlaneWidth(1, width, subsampling) : 0;
    planes.rows = colour ? tjPlaneHeight(1, height, subsampling) : 0;
    planes.u.resize(static_cast<std::size_t>(planes.columns * planes.rows));
    planes.v = planes.u;
    std::array<unsigned char*, 3> to{planes.luma.data(), planes.u.data(), planes.v.data()};
    planes.clean = tjDecompressToYUVPlanes(decoder.get(), jpeg.data(), size, to.data(), width, nullptr, height,
                                           TJFLAG_ACCURATEDCT) == 0;
    return planes;
}

Bytes yuyv_of(const Planes& planes, int width, int height) {
    Bytes frame;
    // Pixels that one value of chroma stands for.
    const int wide = planes.u.empty() ? 1 : (width + planes.columns - 1) / planes.columns;
    const int high = planes.u.empty() ? 1 : (height + planes.rows - 1) / planes.rows;
    const auto chroma = [&](const Bytes& plane, int x, int y) -> std::uint8_t {
        if (plane.empty()) {
            return 128;
        }
        const auto at = static_cast<std::size_t>(y / high * planes.columns + x / wide);
        return wide == 1 ? static_cast<std::uint8_t>((plane[at] + plane[at + 1] + 1) / 2) : plane[at];
    };
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; x += 2) {
            const auto at = static_cast<std::size_t>(y * width + x);
            frame.insert(frame.end(),
                         {planes.luma[at], chroma(planes.u, x, y), planes.luma[at + 1], chroma(planes.v, x, y)});
        }
    }
    return frame;
}

}  // namespace disparityd::capture::test
