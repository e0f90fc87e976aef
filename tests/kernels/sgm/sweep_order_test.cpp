// SPDX-License-Identifier: Apache-2.0
//
// What makes sweeps exact for any number of workers: who takes which rows, and how close rows may follow each other.
#include <algorithm>
#include <set>
#include <thread>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernels/cpu/backend.h"
#include "kernels/cpu/sgm/path_kernels.h"
#include "kernels/cpu/sgm/sgm_kernels.h"
#include "kernels/cpu/sgm/sweep_progress.h"
#include "kernels/cpu/sgm/sweep_scheduler.h"
#include "tests/kernels/guarded.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

using cpu::RowGroup;
using cpu::SweepScheduler;

TEST(SweepScheduler, OneWorkerSweepsDownThenUpThenAcross) {
    SweepScheduler scheduler({{{2, 1}, {1, 2}}});
    auto worker = scheduler.join();
    std::vector<std::vector<int>> taken;
    RowGroup group;
    while (scheduler.claim(worker, group)) {
        taken.push_back({group.sweep, group.part, group.index});
    }
    EXPECT_EQ(scheduler.groups(), 6);
    EXPECT_THAT(taken, testing::ElementsAreArray(std::vector<std::vector<int>>{
                           {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 1}, {1, 1, 2}, {0, 1, 2}}));
}

TEST(SweepScheduler, TwoWorkersKeepToTheirSweeps) {
    SweepScheduler scheduler({{{4, 4}, {4, 4}}});
    auto one = scheduler.join();
    auto other = scheduler.join();
    RowGroup group;
    for (const int index : {0, 1, 2, 3, 4, 5, 6, 7}) {
        ASSERT_TRUE(scheduler.claim(one, group));
        EXPECT_EQ(group.sweep, 0);
        EXPECT_EQ(group.index, index);
        if (index % 3 == 1) {
            scheduler.leave(other);
            other = scheduler.join();
            EXPECT_EQ(other.slot, 1);
        }
        ASSERT_TRUE(scheduler.claim(other, group));
        EXPECT_EQ(group.sweep, 1);
        EXPECT_EQ(group.index, index);
    }
    EXPECT_FALSE(scheduler.claim(one, group));
}

TEST(SweepScheduler, WhoHasNothingLeftHelpsAndGoesBack) {
    SweepScheduler scheduler({{{1, 3}, {3, 1}}});
    auto one = scheduler.join();
    auto other = scheduler.join();
    RowGroup group;
    ASSERT_TRUE(scheduler.claim(one, group));
    ASSERT_TRUE(scheduler.claim(other, group));
    ASSERT_TRUE(scheduler.claim(one, group));
    EXPECT_EQ(group.sweep, 1);
    ASSERT_TRUE(scheduler.claim(other, group));
    EXPECT_EQ(group.sweep, 1);
    EXPECT_EQ(group.index, 2);
    ASSERT_TRUE(scheduler.claim(one, group));
    EXPECT_EQ(group.part, 1);
    EXPECT_EQ(group.sweep, 0);
    EXPECT_EQ(group.index, 1);
}

TEST(SweepScheduler, EveryGroupOnceInOrderWhoeverTakesIt) {
    Random random(60);
    for (int round = 0; round < 200; ++round) {
        const SweepScheduler::Groups groups{
            {{pick(random, 0, 9), pick(random, 0, 9)}, {pick(random, 0, 9), pick(random, 0, 9)}}};
        SweepScheduler scheduler(groups);
        std::vector<SweepScheduler::Worker> workers;
        std::array<int, 2> next{};
        int taken = 0;
        bool second_part = false;
        RowGroup group;
        for (bool more = true; more;) {
            if (workers.empty() || (workers.size() < SweepScheduler::max_workers && pick(random, 0, 3) == 0)) {
                workers.push_back(scheduler.join());
            }
            const auto who = static_cast<std::size_t>(pick(random, 0, static_cast<int>(workers.size()) - 1));
            more = scheduler.claim(workers[who], group);
            if (more) {
                ++taken;
                EXPECT_EQ(group.index, next[static_cast<std::size_t>(group.sweep)]++);
                EXPECT_GE(group.part, second_part ? 1 : 0);
                second_part = group.part == 1;
            }
            if (pick(random, 0, 3) == 0) {
                scheduler.leave(workers[who]);
                workers.erase(workers.begin() + static_cast<std::ptrdiff_t>(who));
            }
            std::set<int> slots;
            for (const SweepScheduler::Worker& worker : workers) {
                slots.insert(worker.slot);
            }
            EXPECT_EQ(slots.size(), workers.size());
        }
        EXPECT_EQ(taken, scheduler.groups());
        ASSERT_FALSE(HasFailure()) << "round " << round;
    }
}

// Two threads that wait for each other in turn, often enough that some waits end asleep.
TEST(SweepProgress, WakesWhoWaits) {
    constexpr int rounds = 400;
    cpu::SweepProgress progress(1);
    std::vector<int> written(2 * rounds);
    const auto take_turns = [&](int first) {
        for (int index = first; index < 2 * rounds; index += 2) {
            progress.wait_for_previous_group({0, 0, index}, 5);
            written[static_cast<std::size_t>(index)] =
                index == 0 ? 1 : written[static_cast<std::size_t>(index) - 1] + 1;
            if (index % 50 == 0) {
                std::this_thread::sleep_for(std::chrono::microseconds(100));  // longer than waiting goes on awake
            }
            progress.reached({0, 0, index}, 3);
            progress.completed({0, 0, index});
        }
    };
    std::thread other(take_turns, 1);
    take_turns(0);
    other.join();
    EXPECT_EQ(written.back(), 2 * rounds);
}

/// One of the variants that paths have, and a P2 of it.
struct VariantInLag {
    const char* name;
    int paths;
    int p2;
};
// What a failure shows; found by GoogleTest.
void PrintTo(const VariantInLag& variant, std::ostream* out) {
    *out << variant.name;
}
constexpr VariantInLag variants_in_lag[] = {
    {"EightPaths", 8, 40}, {"EightPathsU16Sums", 8, 150}, {"FourPaths", 4, 100}, {"FourPathsU16Sums", 4, 150}};

// Rows of one sweep, worked on step by step in any order that `before` allows.
class InterleavedRows {
public:
    InterleavedRows(const cpu::SgmKernels& kernels, int p2, int width, int rows, int disparities, Random& random)
        : kernels_(kernels),
          p2_(p2),
          width_(width),
          rows_(rows),
          sums_(sum_bytes() * size(width, rows)),
          costs_(size(width, rows)) {
        geometry_.width = width;
        geometry_.height = rows;
        geometry_.range = {0, disparities};
        geometry_.layout = kernels.layout;
        std::generate_n(costs_.data(), costs_.size(), [&] { return static_cast<std::uint8_t>(pick(random, 0, 62)); });
    }

    /// `closely`: a row goes on as soon as it may. Else each row is finished before the next begins.
    std::vector<std::uint8_t> run(int direction, bool closely) {
        const int at_once = kernels_.rows_at_once;
        const int groups = (rows_ + at_once - 1) / at_once;
        const auto pixels = static_cast<std::size_t>(width_ + 2 * cpu::path_guard);
        const GuardedMemory<std::uint8_t> costs(3 * pixels * kernels_.layout.bytes());
        const GuardedMemory<std::uint8_t> least(3 * pixels);
        std::fill_n(costs.data(), costs.size(), std::uint8_t{0});
        std::fill_n(least.data(), least.size(), std::uint8_t{0});
        for (std::size_t i = 0; i < 3; ++i) {
            before_.costs[i] = costs.data() + (i * pixels + cpu::path_guard) * kernels_.layout.bytes();
            before_.least[i] = least.data() + i * pixels + cpu::path_guard;
        }
        const GuardedMemory<std::uint8_t> states(static_cast<std::size_t>(groups * cpu::max_sweep_state));
        states_ = states.data();
        steps_.assign(static_cast<std::size_t>(groups), 0);
        for (bool some = true; some;) {
            some = false;
            for (int i = 0; i < groups && !some; ++i) {
                some = advance(direction, closely ? groups - 1 - i : i);
            }
        }
        EXPECT_TRUE(costs.intact() && least.intact() && states.intact() && sums_.intact());
        return {sums_.data(), sums_.data() + sums_.size()};
    }

private:
    std::size_t size(int width, int rows) const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(rows) * kernels_.layout.bytes();
    }

    int count(int group) const { return std::min(kernels_.rows_at_once, rows_ - group * kernels_.rows_at_once); }

    // One block of a group of rows, if there is one left and the group before is far enough.
    bool advance(int direction, int group) {
        int& done = steps_[static_cast<std::size_t>(group)];
        const cpu::SweepSteps steps{done, done + cpu::min_block};
        if (done == cpu::steps_of(width_, count(group))) {
            return false;
        }
        if (group > 0 && cpu::done_after(steps_[static_cast<std::size_t>(group) - 1], width_, count(group - 1)) <
                             std::min(steps.end + 1, width_)) {
            return false;
        }
        const std::vector<std::uint8_t> p2_row(static_cast<std::size_t>(width_ + 2 * cpu::path_guard),
                                               static_cast<std::uint8_t>(p2_));
        cpu::SweepRow rows[2];
        for (int i = 0; i < count(group); ++i) {
            const std::size_t at = size(width_, group * kernels_.rows_at_once + i);
            rows[i].costs = costs_.data() + at;
            rows[i].sums = sums_.data() + sum_bytes() * at;
            std::fill_n(rows[i].p2_rows, 4, p2_row.data());
        }
        kernels_.aggregate(geometry_, {direction, 7, p2_, cpu::Store::keep}, before_, rows, count(group), steps,
                           states_ + group * cpu::max_sweep_state);
        done = steps.end;
        return true;
    }

    std::size_t sum_bytes() const { return static_cast<std::size_t>(kernels_.sum_bytes); }

    cpu::SgmKernels kernels_;
    int p2_;
    int width_;
    int rows_;
    GuardedMemory<std::uint8_t> sums_;
    GuardedMemory<std::uint8_t> costs_;
    cpu::MatchGeometry geometry_;
    cpu::PathRow before_;
    std::uint8_t* states_ = nullptr;
    std::vector<int> steps_;
};

class RowsInLag : public testing::TestWithParam<std::tuple<cpu::InstructionSet, VariantInLag>> {};

TEST_P(RowsInLag, EqualRowsOneAfterTheOther) {
    Random random(61);
    const auto& [set, variant] = GetParam();
    MatchOptions options;
    options.sgm.paths = variant.paths;
    options.sgm.p2 = variant.p2;
    for (const int disparities : {16, 32, 64, 128, 192, 256}) {
        options.range.count = disparities;
        const cpu::SgmKernels kernels = cpu::path_kernels(set.target, options);
        for (const int width : {1, 17, 64, 150, 259}) {
            InterleavedRows rows(kernels, variant.p2, width, 7, disparities, random);
            for (const int direction : {1, -1}) {
                EXPECT_EQ(rows.run(direction, true), rows.run(direction, false))
                    << "D " << disparities << ", " << width;
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(CpuKernels, RowsInLag,
                         testing::Combine(testing::ValuesIn(cpu::instruction_sets()),
                                          testing::ValuesIn(variants_in_lag)),
                         [](const auto& set) {
                             return std::get<0>(set.param).name + "_" + std::get<1>(set.param).name;
                         });

}  // namespace
}  // namespace disparityd::test
