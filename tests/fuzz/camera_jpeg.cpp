// SPDX-License-Identifier: Apache-2.0
//
// The JPEGs that a camera sends.
#include <array>
#include <string_view>
#include <vector>

#include "capture/jpeg_decoder.h"
#include "tests/fuzz/outcome.h"

using namespace disparityd;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // A picture of 64 x 32, in each layout: the decoder outlives every input.
    constexpr std::array<capture::EyeLayout, 4> layouts{
        {{32, 32, false, false}, {32, 32, false, true}, {64, 16, true, false}, {64, 16, true, true}}};
    static std::array<capture::JpegDecoder, 4> decoders{
        capture::JpegDecoder(layouts[0]), capture::JpegDecoder(layouts[1]), capture::JpegDecoder(layouts[2]),
        capture::JpegDecoder(layouts[3])};
    bool refused = false;
    for (std::size_t i = 0; i < decoders.size(); ++i) {
        std::vector<std::uint8_t> frame(std::size_t{64} * 32 * 2);
        const char* problem = decoders[i].decode({data, size}, frame.data());
        fuzz::expect(i == 0 || refused == (problem != nullptr), "a layout decides whether a JPEG is damaged");
        refused = problem != nullptr;
        if (refused) {
            fuzz::expect_line(problem, "");
        }
    }
    return 0;
}
