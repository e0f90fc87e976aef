// SPDX-License-Identifier: Apache-2.0
//
// Prints the nearest measured depth of each frame, over shared memory. Waits for the daemon when it is not there.
//   nearest-cpp [NAME]
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>

#include <disparity_client.hpp>

namespace {

/// In mm; 0 when nothing was measured. Confidence 0 marks pixels that were rejected or filled in.
unsigned nearest(const disparity::PlaneData& depth, const disparity::PlaneData& confidence) {
    unsigned best = 0;
    for (std::size_t i = 0; i < confidence.bytes.size(); ++i) {
        std::uint16_t mm = 0;
        std::memcpy(&mm, depth.bytes.data() + 2 * i, sizeof mm);
        if (confidence.bytes[i] != 0 && mm != 0 && (best == 0 || mm < best)) {
            best = mm;
        }
    }
    return best;
}

}  // namespace

int main(int argc, char** argv) {
    using disparity::Product;
    using disparity::ReadResult;
    try {
        disparity::SharedMemoryReader reader(argc > 1 ? argv[1] : "default", {.may_be_absent = true});
        disparity::Frame frame;  // used again for every frame: its buffers stay
        while (true) {
            const ReadResult result =
                reader.read(frame, std::chrono::seconds(1), {Product::depth, Product::confidence});
            if (result == ReadResult::gone) {
                std::printf("waiting for the daemon: %s\n", reader.why_gone().c_str());
                std::fflush(stdout);
                continue;  // the next read looks for it again
            }
            if (result == ReadResult::timeout) {
                std::puts("no frame for a second");
                continue;
            }
            const disparity::PlaneData* depth = frame.plane(Product::depth);
            const disparity::PlaneData* confidence = frame.plane(Product::confidence);
            if (depth == nullptr || confidence == nullptr) {
                std::fputs("nearest-cpp: error: the daemon does not publish depth and confidence\n", stderr);
                return 1;
            }
            std::printf("frame %llu  %.1f ms old  nearest %u mm  missed %llu\n",
                        static_cast<unsigned long long>(frame.sequence), static_cast<double>(frame.age_ns) / 1e6,
                        nearest(*depth, *confidence), static_cast<unsigned long long>(frame.missed));
            std::fflush(stdout);
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "nearest-cpp: error: %s\n", error.what());
        return 1;
    }
}
