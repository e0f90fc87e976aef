// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/emulation/with_settings.h"
#include "tools/bench/line_up.h"

// disparity-bench takes the GPU where there is one.
namespace disparityd::bench {
namespace {

using testing::HasSubstr;

Contestants lined_up(const std::vector<std::string>& words) {
    static WorkerPools pools;
    check_contestants(words);
    std::map<std::string, MatchOptions> options;
    for (const Method method : {Method::sad, Method::census, Method::sgm}) {
        options["cpu/" + std::string(to_string(method))] = default_options(method, {0, 16});
    }
    return line_up(render(64, 48, 16), {words, parse_instruction_sets("best"), {1}}, options, pools);
}

std::ptrdiff_t of_gpu(const Contestants& all) {
    return std::count_if(all.begin(), all.end(), [](const auto& one) { return one->isa == "GPU"; });
}

TEST(EmulatedCudaBench, TheGpuTakesPartWithItsStepTimes) {
    const Contestants all = lined_up({"cuda"});
    ASSERT_EQ(all.size(), 3U);
    EXPECT_EQ(of_gpu(all), 3);
    all.front()->prepare();
    all.front()->run();
    all.front()->finish();
    EXPECT_EQ(all.front()->name, "cuda/sgm");
    EXPECT_EQ(all.front()->steps().front().step, "upload");
    EXPECT_EQ(of_gpu(lined_up({"cpu"})), 0);
}

TEST(EmulatedCudaBench, WithoutAGpuWhoAsksForItIsToldWhy) {
    simt::Machine none;
    none.devices = 0;
    const test::WithMachine machine(none);
    try {
        lined_up({"cuda/sad"});
        FAIL() << "there is no device";
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), HasSubstr("no GPU"));
    }
}

}  // namespace
}  // namespace disparityd::bench
