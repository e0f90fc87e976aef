// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/cuda/compare.h"
#include "tests/cuda/device_under_test.h"

// On a real device only: frames with more strips than run at a time, again and again, so that what is right by luck has
// the chance to go wrong.
namespace disparityd::test {
namespace {

class CudaLargeFrames : public CudaDevice, public testing::WithParamInterface<std::array<int, 3>> {};

TEST_P(CudaLargeFrames, EqualThoseOfTheProcessorEveryTime) {
    const auto [width, height, disparities] = GetParam();
    constexpr int times = 20;
    Random random(80);
    Serial serial;
    const Bytes left = noise(random, width, height);
    const Pair pair(left, shifted(random, left, -disparities / 3));
    for (const bool adaptive : {false, true}) {
        for (const int p2 : {60, 193}) {
            MatchOptions options = default_options(Method::sgm, {0, disparities});
            options.sgm.p2 = p2;
            options.sgm.adaptive_p2 = adaptive;
            const Result expected = result_of("cpu", pair, options);
            const auto matcher = backend("cuda").create({width, height, options});
            for (int i = 0; i < times; ++i) {
                Frame frame(*matcher, pair.left, pair.right);
                match_pair(*matcher, frame.view, serial);
                // Not ASSERT_EQ: a million numbers would be printed.
                ASSERT_TRUE(Result(frame) == expected)
                    << "frame " << i << ", P2 " << p2 << (adaptive ? ", adaptive" : "");
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, CudaLargeFrames,
                         testing::Values(std::array{640, 480, 64}, std::array{1280, 720, 128},
                                         std::array{1920, 1080, 256}));

}  // namespace
}  // namespace disparityd::test
