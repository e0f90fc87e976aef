// SPDX-License-Identifier: Apache-2.0
//
// What a configured matcher of the cpu back end holds for SGM, and that a frame takes no more.
#include <algorithm>
#include <memory>

#include <gtest/gtest.h>

#include "kernels/cpu/backend.h"
#include "kernels/large_buffer.h"
#include "pipeline/worker_pool.h"
#include "tests/kernels/counted_memory.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

MatchOptions sgm_options(int paths, int p2, int disparities) {
    MatchOptions options;
    options.range = {0, disparities};
    options.sgm = {paths, 10, p2, true};
    return options;
}

TEST(CountedMemory, Counts) {
    counted_memory::reset();
    auto* volatile number = new int(7);
    const auto calls = counted_memory::calls();
    const auto bytes = counted_memory::bytes();
    delete number;
    EXPECT_EQ(calls, 1U);
    EXPECT_EQ(bytes, sizeof(int));
    const LargeBuffer pages(5000000);
    EXPECT_GE(counted_memory::bytes(), bytes + 5000000);
}

// What `disparities` take in registers, where these are largest.
int with_padding(int disparities) {
    const auto sizes = {16, 32, 64, 96, 128, 192, 256};
    return *std::find_if(sizes.begin(), sizes.end(), [&](int size) { return size >= disparities; });
}

class MatcherMemory : public testing::TestWithParam<cpu::InstructionSet> {
protected:
    // Bytes asked for by the time that the matcher is ready.
    double held(int width, int height, const MatchOptions& options) const {
        counted_memory::reset();
        const auto matcher = cpu::create({width, height, options}, GetParam());
        return static_cast<double>(counted_memory::bytes());
    }
};

TEST_P(MatcherMemory, IsBounded) {
    for (const auto& [width, height] : {std::pair{450, 375}, {1280, 720}, {2000, 1500}, {8192, 20}, {8192, 1}}) {
        for (int disparities = 16; disparities <= max_disparities; disparities += 16) {
            for (const int p2 : {20, 63, 64, 193}) {
                const double candidates = 1.0 * width * height * with_padding(disparities);
                const double allowed = (p2 <= 63 ? 2.1 : 3.1) * candidates + 64e6;
                for (const int paths : {8, 4}) {
                    EXPECT_LE(held(width, height, sgm_options(paths, p2, disparities)), allowed)
                        << width << "x" << height << ", D " << disparities << ", " << paths << " paths, P2 " << p2;
                }
            }
        }
    }
}

// 80 candidates in registers of 64 bytes would be 128; the 64 MB that are allowed for everything else do not cover it.
TEST_P(MatcherMemory, IsBoundedWherePaddingIsLargest) {
    EXPECT_LE(held(4500, 2500, sgm_options(8, 193, 80)), 3.1 * 4500 * 2500 * with_padding(80) + 64e6);
    EXPECT_LE(held(4500, 2500, sgm_options(4, 63, 144)), 2.1 * 4500 * 2500 * with_padding(144) + 64e6);
}

TEST_P(MatcherMemory, NothingIsAskedForPerFrame) {
    Random random(80);
    pipeline::WorkerPool workers(6);
    for (const int paths : {8, 4}) {
        for (const int p2 : {63, 193}) {
            const Image<std::uint8_t> image = noise(random, 200, 100);
            const auto matcher = cpu::create({200, 100, sgm_options(paths, p2, 48)}, GetParam());
            const Frame frame(*matcher, image, image);
            match_pair(*matcher, frame.view, workers);
            counted_memory::reset();
            for (int i = 0; i < 5; ++i) {
                match_pair(*matcher, frame.view, workers);
            }
            EXPECT_EQ(counted_memory::calls(), 0U) << paths << " paths, P2 " << p2;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(CpuKernels, MatcherMemory, testing::ValuesIn(cpu::instruction_sets()),
                         [](const auto& set) { return set.param.name; });

}  // namespace
}  // namespace disparityd::test
