// SPDX-License-Identifier: Apache-2.0
// Threads that are lent to kernels need no more stack than parallel.h says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include "kernels/cpu/backend.h"
#include "tests/kernels/any_pair.h"

namespace disparityd::test {
namespace {

/// One thread with as little stack as tasks may count on.
class SmallStack final : public Parallel {
public:
    int workers() const override { return 1; }
    void for_each(int count, FunctionRef<void(int)> task) override {
        Tasks tasks{count, task};
        pthread_attr_t attributes;
        pthread_t thread{};
        ASSERT_EQ(pthread_attr_init(&attributes), 0);
        ASSERT_EQ(pthread_attr_setstacksize(&attributes, std::size_t{256} << 10), 0);
        ASSERT_EQ(pthread_create(&thread, &attributes, run, &tasks), 0);
        ASSERT_EQ(pthread_join(thread, nullptr), 0);
        pthread_attr_destroy(&attributes);
    }

private:
    struct Tasks {
        int count;
        FunctionRef<void(int)> task;
    };
    static void* run(void* argument) {
        const auto& tasks = *static_cast<const Tasks*>(argument);
        for (int i = 0; i < tasks.count; ++i) {
            tasks.task(i);
        }
        return nullptr;
    }
};

class StackOfEveryInstructionSet : public testing::TestWithParam<cpu::InstructionSet> {};

// On rows as long as they may be: an overflow is a crash.
TEST_P(StackOfEveryInstructionSet, IsEnoughOnTheLongestRows) {
    Random random(29);
    const Pair pair(random, max_side, 2);
    SmallStack small_stack;
    for (const int disparities : {16, 128, 256}) {
        for (const auto& [method, paths, p2] : {std::tuple{Method::sad, 8, 2},
                                                {Method::census, 8, 2},
                                                {Method::sgm, 8, 63},
                                                {Method::sgm, 8, 193},
                                                {Method::sgm, 4, 127},
                                                {Method::sgm, 4, 193}}) {
            MatchOptions options = default_options(method, {0, disparities});
            options.sgm.paths = paths;
            options.sgm.p2 = p2;
            options.sgm.p1 = p2 / 2;
            options.post.interpolate = true;
            options.post.guided_median = 7;
            options.cost = p2 == 63 || paths == 4 ? CensusCost::census_7x5_gradient : CensusCost::census_9x7;
            options.noise_level = paths == 4 && p2 == 193 ? 3 : 0;
            const auto matcher = cpu::create({max_side, 2, options}, GetParam());
            expect_equal_to_reference(*matcher, pair, small_stack);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(CpuKernels, StackOfEveryInstructionSet, testing::ValuesIn(cpu::instruction_sets()),
                         [](const auto& set) { return set.param.name; });

}  // namespace
}  // namespace disparityd::test
