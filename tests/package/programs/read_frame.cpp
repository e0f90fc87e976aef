// SPDX-License-Identifier: Apache-2.0
// Reads one frame of the daemon NAME and says how large its depth is: read_frame NAME
#include <chrono>
#include <cstdio>
#include <exception>

#include <disparity_client.hpp>

int main(int, char** argv) try {
    disparity::SharedMemoryReader reader(argv[1], {.may_be_absent = true});
    disparity::Frame frame;
    if (reader.read(frame, std::chrono::seconds(20)) != disparity::ReadResult::frame) {
        std::fprintf(stderr, "read_frame: error: no frame: %s\n", reader.why_gone().c_str());
        return 1;
    }
    const disparity::PlaneData* depth = frame.plane(disparity::Product::depth);
    std::printf("depth of %ux%u\n", depth->width, depth->height);
    return depth->bytes.size() == 2UL * depth->width * depth->height ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "read_frame: error: %s\n", error.what());
    return 1;
}
