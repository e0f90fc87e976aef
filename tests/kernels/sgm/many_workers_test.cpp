// SPDX-License-Identifier: Apache-2.0
//
// SGM gives the same bytes however many workers there are, and whatever of them turns up.
#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "kernels/cpu/backend.h"
#include "tests/kernels/sgm/sgm_case.h"

namespace disparityd::test {
namespace {

// Says that there are many workers where all tasks run in the caller's thread, the last first.
class Backwards final : public Parallel {
public:
    explicit Backwards(int workers) : workers_(workers) {}
    int workers() const override { return workers_; }
    void for_each(int count, FunctionRef<void(int)> task) override {
        for (int i = count - 1; i >= 0; --i) {
            task(i);
        }
    }

private:
    int workers_;
};

// Fewer threads than workers, and each leaves after a few tasks: the caller does what is left.
class Deserters final : public Parallel {
public:
    Deserters(int workers, int threads, int tasks_each)
        : workers_(workers), threads_(threads), tasks_each_(tasks_each) {}
    int workers() const override { return workers_; }
    void for_each(int count, FunctionRef<void(int)> task) override {
        std::atomic<int> next{0};
        const auto run = [&](int most) {
            for (int i = 0; i < most; ++i) {
                const int index = next.fetch_add(1);
                if (index >= count) {
                    return;
                }
                task(index);
            }
        };
        std::vector<std::thread> threads;
        for (int i = 0; i < threads_; ++i) {
            threads.emplace_back(run, tasks_each_);
        }
        run(count);
        for (std::thread& thread : threads) {
            thread.join();
        }
    }

private:
    int workers_;
    int threads_;
    int tasks_each_;
};

class ManyWorkers : public testing::TestWithParam<cpu::InstructionSet> {
protected:
    static SgmCase any_case(Random& random, int min_width, int max_width, int max_height) {
        return random_case(random, pick(random, min_width, max_width), pick(random, 1, max_height),
                           random_sgm_options(random, 8, 2, cpu::max_byte_p2));
    }
};

TEST_P(ManyWorkers, OneToThirtyTwo) {
    Random random(50);
    for (int count = 1; count <= 32; ++count) {
        ShuffledWorkers workers(count, static_cast<unsigned>(random()));
        any_case(random, 1, 170, 40).expect_from(GetParam().target, count % 3 == 0 ? in_cache : 0, workers);
    }
}

TEST_P(ManyWorkers, MoreThanRows) {
    Random random(51);
    for (const int count : {2, 3, 7, 32}) {
        for (const int height : {1, 2, 3}) {
            ShuffledWorkers workers(count, static_cast<unsigned>(random()));
            random_case(random, pick(random, 1, 70), height, random_sgm_options(random, 8, 2, cpu::max_byte_p2))
                .expect_from(GetParam().target, 0, workers);
        }
    }
}

TEST_P(ManyWorkers, MoreThanThereIsMemoryFor) {
    Random random(52);
    ShuffledWorkers workers(cpu::SweepScheduler::max_workers + 30, 1);
    any_case(random, 100, 200, 60).expect_from(GetParam().target, 0, workers);
}

// Rows so long that several are on their way at the same time, and short tasks.
TEST_P(ManyWorkers, InLongRows) {
    Random random(53);
    MatchOptions options = random_sgm_options(random, 8, 2, cpu::max_byte_p2);
    for (const int disparities : {16, 64, 128}) {
        for (const int count : {3, 8}) {
            options.range = {-3, disparities};
            ShuffledWorkers workers(count, static_cast<unsigned>(random()));
            random_case(random, pick(random, 500, 700), 20, options).expect_from(GetParam().target, 0, workers);
        }
    }
}

TEST_P(ManyWorkers, WhoDoNotTurnUp) {
    Random random(54);
    for (const int count : {2, 3, 8, 32}) {
        Backwards backwards(count);
        any_case(random, 1, 200, 60).expect_from(GetParam().target, 0, backwards);
    }
}

TEST_P(ManyWorkers, WhoLeaveEarly) {
    Random random(55);
    for (int round = 0; round < 6; ++round) {
        Deserters workers(pick(random, 4, 32), pick(random, 1, 3), pick(random, 1, 4));
        any_case(random, 1, 200, 60).expect_from(GetParam().target, 0, workers);
    }
}

INSTANTIATE_TEST_SUITE_P(CpuKernels, ManyWorkers, testing::ValuesIn(cpu::instruction_sets()),
                         [](const auto& set) { return set.param.name; });

}  // namespace
}  // namespace disparityd::test
