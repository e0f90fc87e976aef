// SPDX-License-Identifier: Apache-2.0
//
// Measures the processor time that a camera's JPEGs cost: disparity-jpeg-load EYE_WIDTH HEIGHT RATE [QUALITY]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <stdexcept>
#include <vector>

#include "capture/jpeg_decoder.h"
#include "capture/scene/scene_render.h"
#include "lab/jpeg-load/yuyv_jpeg.h"

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
        jpegs.push_back(jpeg_of(frame, 2 * eye_width, height, quality));
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
