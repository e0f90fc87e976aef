// SPDX-License-Identifier: Apache-2.0
//
// Prints the nearest measured point of each frame. Waits for the daemon when it is not there.
//   nearest-cpp [NAME | unix:PATH | tcp:HOST:PORT | tls:HOST:PORT]
#include <cmath>
#include <cstdio>
#include <exception>

#include <disparity_client.hpp>

namespace {

/// Returns the nearest point; z is NaN when nothing was measured. Confidence 0 marks pixels that were rejected or
/// filled.
disparity::Point nearest(const disparity::Points& points, const disparity::PlaneData& confidence) {
    disparity::Point best;
    best.z = NAN;
    for (std::size_t i = 0; i < points.points.size(); ++i) {
        const disparity::Point& point = points.points[i];
        if (confidence.bytes[i] != 0 && (point.z < best.z || std::isnan(best.z))) {
            best = point;
        }
    }
    return best;
}

}  // namespace

int main(int argc, char** argv) {
    using disparity::Product;
    try {
        disparity::Client daemon = disparity::connect(
            argc > 1 ? argv[1] : "", {.products = {Product::disparity, Product::confidence}}, {.may_be_absent = true});
        disparity::Frame frame;  // used again for every frame: its buffers stay
        while (true) {
            switch (daemon.read(frame, std::chrono::seconds(1))) {
                case disparity::ReadResult::gone:  // the next read looks for it again
                    std::printf("waiting for the daemon: %s\n", daemon.why_gone().c_str());
                    break;
                case disparity::ReadResult::timeout: std::puts("no frame for a second"); break;
                case disparity::ReadResult::frame:
                    const auto points = frame.points();
                    const disparity::PlaneData* confidence = frame.plane(Product::confidence);
                    if (!points || confidence == nullptr) {
                        std::fputs("nearest-cpp: error: the frame has no points: the camera is not calibrated\n",
                                   stderr);
                        return 1;
                    }
                    const disparity::Point point = nearest(*points, *confidence);
                    std::printf("frame %llu  %.1f ms old  nearest %.3f m, %.3f m to the right\n",
                                static_cast<unsigned long long>(frame.sequence),
                                static_cast<double>(frame.age_ns) / 1e6, point.z, point.x);
            }
            std::fflush(stdout);
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "nearest-cpp: error: %s\n", error.what());
        return 1;
    }
}
