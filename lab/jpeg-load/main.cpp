// SPDX-License-Identifier: Apache-2.0
//
// Measures the processor time that a camera's JPEGs cost: disparity-jpeg-load EYE_WIDTH HEIGHT RATE [QUALITY]
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <stdexcept>
#include <vector>

#include <turbojpeg.h>

#include "capture/jpeg_decoder.h"
#include "capture/scene/scene_render.h"

namespace disparityd::lab {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr int decoded_frames = 200;

/// Of this thread; independent of what else the machine does, but for the caches.
double processor_ms() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) / 1e6;
}

struct EndTurbo {
    void operator()(void* handle) const { tjDestroy(handle); }
};

/// Returns a frame of YUYV as a JPEG of half as many columns of chroma, as most cameras send it.
Bytes encode(const Bytes& yuyv, int width, int height, int quality) {
    Bytes luma, u, v;
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
    Bytes bytes(jpeg, jpeg + size);
    tjFree(jpeg);
    return bytes;
}

void measure(int eye_width, int height, double rate, int quality) {
    capture::SceneOptions options;
    options.width = eye_width;
    options.height = height;
    options.loop = 4;
    const capture::SceneRenderer renderer(options);
    std::vector<Bytes> jpegs;
    std::size_t bytes = 0;
    Bytes frame(renderer.frame_bytes());
    for (int i = 0; i < options.loop; ++i) {
        renderer.render(i, frame.data(), [] {});
        jpegs.push_back(encode(frame, 2 * eye_width, height, quality));
        bytes += jpegs.back().size();
    }
    capture::JpegDecoder decoder({eye_width, height, false, false});
    std::vector<double> times;
    for (std::size_t i = 0; i < decoded_frames; ++i) {
        const double begin = processor_ms();
        if (const char* problem = decoder.decode(jpegs[i % jpegs.size()], frame.data()); problem != nullptr) {
            throw std::runtime_error(problem);
        }
        times.push_back(processor_ms() - begin);
    }
    std::sort(times.begin(), times.end());
    const double median = times[times.size() / 2];
    std::printf("%dx%d, quality %d, %zu KB a frame: %.2f ms of processor time (p90 %.2f), %.1f %% of a core at %g/s\n",
                2 * eye_width, height, quality, bytes / jpegs.size() / 1000, median, times[times.size() * 9 / 10],
                median * rate / 10, rate);
}

}  // namespace
}  // namespace disparityd::lab

int main(int argc, char** argv) {
    if (argc < 4) {
        std::fprintf(stderr, "usage: disparity-jpeg-load EYE_WIDTH HEIGHT RATE [QUALITY]\n");
        return 2;
    }
    try {
        disparityd::lab::measure(std::atoi(argv[1]), std::atoi(argv[2]), std::atof(argv[3]),
                                 argc > 4 ? std::atoi(argv[4]) : 90);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "disparity-jpeg-load: error: %s\n", error.what());
        return 1;
    }
    return 0;
}
