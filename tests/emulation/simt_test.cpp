// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <numeric>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include <cuda_runtime.h>
#include <gtest/gtest.h>

#include "tests/emulation/with_settings.h"

namespace disparityd::simt {

// What ctest lists; found by GoogleTest in the namespace of the type.
static void PrintTo(Order order, std::ostream* out) {
    constexpr std::array names = {"ascending", "descending", "shuffled"};
    *out << names[static_cast<std::size_t>(order)];
}

}  // namespace disparityd::simt

namespace disparityd::test {
namespace {

using simt::Order;
using simt::run;

class EveryOrder : public testing::TestWithParam<Order> {
private:
    WithSettings settings_{{GetParam(), 7, 0xa5, false}};
};

TEST_P(EveryOrder, EveryThreadOfEveryBlockRunsOnce) {
    const dim3 grid(3, 2, 2);
    const dim3 block(5, 3, 2);
    std::vector<int> count(12 * 30);
    run(grid, block, 0, [&] {
        EXPECT_EQ(blockDim.x * blockDim.y * blockDim.z, 30U);
        EXPECT_EQ(gridDim.y, 2U);
        const unsigned b = (blockIdx.z * 2 + blockIdx.y) * 3 + blockIdx.x;
        const unsigned t = (threadIdx.z * 3 + threadIdx.y) * 5 + threadIdx.x;
        ++count[b * 30 + t];
    });
    EXPECT_EQ(count, std::vector<int>(360, 1));
}

TEST_P(EveryOrder, NobodyPassesABarrierBeforeAllHaveCome) {
    int before = 0;
    int after = 0;
    run(dim3(2), dim3(70), 0, [&] {
        for (int round = 1; round <= 3; ++round) {
            ++before;
            __syncthreads();
            EXPECT_EQ(before % 70, 0);
            __syncthreads();
            ++after;
        }
    });
    EXPECT_EQ(before, 2 * 3 * 70);
    EXPECT_EQ(after, 2 * 3 * 70);
}

TEST_P(EveryOrder, SharedMemoryIsTheBlocksOwn) {
    run(dim3(4), dim3(40), 160, [&] {
        auto& fixed = simt::shared<unsigned[40]>([] {});
        auto* dynamic = static_cast<unsigned*>(simt::dynamic_shared_memory());
        EXPECT_EQ(fixed[threadIdx.x], 0xa5a5a5a5) << "left from the block before";
        EXPECT_EQ(dynamic[threadIdx.x], 0xa5a5a5a5);
        fixed[threadIdx.x] = threadIdx.x;
        dynamic[threadIdx.x] = 100 + threadIdx.x;
        __syncthreads();
        EXPECT_EQ(fixed[39 - threadIdx.x], 39 - threadIdx.x);
        EXPECT_EQ(dynamic[39 - threadIdx.x], 139 - threadIdx.x);
    });
}

TEST_P(EveryOrder, ShufflesReadWhatTheGuideSays) {
    run(dim3(1), dim3(64), 0, [&] {
        const int lane = static_cast<int>(threadIdx.x % 32);
        const int base = static_cast<int>(threadIdx.x) - lane;
        const int value = base + lane;
        EXPECT_EQ(__shfl_sync(0xffffffff, value, 5), base + 5);
        EXPECT_EQ(__shfl_sync(0xffffffff, value, (lane + 1) % 32), base + (lane + 1) % 32);
        EXPECT_EQ(__shfl_sync(0xffffffff, value, 33), base + 1) << "modulo the width";
        EXPECT_EQ(__shfl_sync(0xffffffff, value, 2, 8), base + lane / 8 * 8 + 2);
        EXPECT_EQ(__shfl_up_sync(0xffffffff, value, 3), lane < 3 ? value : value - 3);
        EXPECT_EQ(__shfl_up_sync(0xffffffff, value, 3, 8), lane % 8 < 3 ? value : value - 3);
        EXPECT_EQ(__shfl_down_sync(0xffffffff, value, 3), lane >= 29 ? value : value + 3);
        EXPECT_EQ(__shfl_down_sync(0xffffffff, value, 3, 16), lane % 16 >= 13 ? value : value + 3);
        EXPECT_EQ(__shfl_xor_sync(0xffffffff, value, 16), base + (lane ^ 16));
        EXPECT_EQ(__shfl_xor_sync(0xffffffff, value, 16, 16), lane >= 16 ? value - 16 : value)
            << "an earlier section may be read, a later one not";
        EXPECT_EQ(__shfl_sync(0xffffffff, 1.5 * lane, 31), 46.5) << "64 bits";
    });
}

TEST_P(EveryOrder, VotesAndReductionsSeeTheLanesOfTheMask) {
    run(dim3(1), dim3(32), 0, [&] {
        const int lane = static_cast<int>(threadIdx.x);
        EXPECT_EQ(__ballot_sync(0xffffffff, lane % 3 == 0), 0x49249249U);
        EXPECT_EQ(__any_sync(0xffffffff, lane == 9), 1);
        EXPECT_EQ(__any_sync(0xffffffff, 0), 0);
        EXPECT_EQ(__all_sync(0xffffffff, lane != 9), 0);
        EXPECT_EQ(__all_sync(0xffffffff, 5), 1);
        const unsigned value = 100U + static_cast<unsigned>(lane);
        EXPECT_EQ(__reduce_min_sync(0xffffffff, value), 100U);
        EXPECT_EQ(__reduce_max_sync(0xffffffff, value), 131U);
        EXPECT_EQ(__reduce_add_sync(0xffffffff, value), 3696U);
        EXPECT_EQ(__reduce_and_sync(0xffffffff, value | 0x8000), 0x8000U);
        EXPECT_EQ(__reduce_or_sync(0xffffffff, 1U << lane), 0xffffffffU);
        if (lane < 8) {
            EXPECT_EQ(__ballot_sync(0xff, 1), 0xffU);
            EXPECT_EQ(__reduce_add_sync(0xff, 2U), 16U);
        } else {
            EXPECT_EQ(__reduce_min_sync(0xffffff00, value), 108U);
        }
    });
}

TEST_P(EveryOrder, LanesSeeEachOthersWritesAfterSyncwarp) {
    run(dim3(1), dim3(96), 0, [&] {
        auto& values = simt::shared<unsigned[96]>([] {});
        for (unsigned round = 0; round < 4; ++round) {
            values[threadIdx.x] = threadIdx.x + round;
            __syncwarp();
            EXPECT_EQ(values[threadIdx.x ^ 1], (threadIdx.x ^ 1) + round);
            __syncwarp();
        }
    });
}

TEST_P(EveryOrder, AtomicsReturnWhatWasThere) {
    for (const bool turns : {false, true}) {
        const WithSettings settings{{GetParam(), 3, 0, turns}};
        unsigned sum = 0;
        unsigned least = 1000;
        unsigned taken = 0;
        std::set<unsigned> seen;
        run(dim3(2), dim3(50), 0, [&] {
            seen.insert(atomicAdd(&sum, 1U));
            atomicMin(&least, 7 + threadIdx.x + blockIdx.x);
            if (atomicCAS(&taken, 0U, 1U) == 0) {
                taken += 1;
            }
        });
        EXPECT_EQ(sum, 100U);
        EXPECT_EQ(seen.size(), 100U);
        EXPECT_EQ(least, 7U);
        EXPECT_EQ(taken, 2U);
    }
}

std::string name_of(const testing::TestParamInfo<Order>& instance) {
    return testing::PrintToString(instance.param);
}

INSTANTIATE_TEST_SUITE_P(Simt, EveryOrder, testing::Values(Order::ascending, Order::descending, Order::shuffled),
                         name_of);

TEST(Simt, ThreadsTakeTurnsInTheOrderAskedFor) {
    const auto order_of = [](Order order, unsigned seed) {
        const WithSettings settings{{order, seed, 0, false}};
        std::vector<unsigned> turns;
        run(dim3(1), dim3(40), 0, [&] { turns.push_back(threadIdx.x); });
        return turns;
    };
    std::vector<unsigned> up(40);
    std::iota(up.begin(), up.end(), 0U);
    EXPECT_EQ(order_of(Order::ascending, 1), up);
    EXPECT_EQ(order_of(Order::descending, 1), std::vector<unsigned>(up.rbegin(), up.rend()));
    EXPECT_NE(order_of(Order::shuffled, 1), order_of(Order::shuffled, 2));
    EXPECT_EQ(order_of(Order::shuffled, 1), order_of(Order::shuffled, 1));
}

TEST(Simt, AThrowingKernelEndsTheLaunchAndTheNextOneRuns) {
    EXPECT_THROW(run(dim3(2), dim3(64), 0,
                     [&] {
                         __syncthreads();
                         if (threadIdx.x == 40) {
                             throw std::out_of_range("test");
                         }
                         __syncthreads();
                     }),
                 std::out_of_range);
    int count = 0;
    run(dim3(1), dim3(64), 0, [&] { ++count; });
    EXPECT_EQ(count, 64);
}

TEST(Runtime, NothingHappensBeforeSomebodyWaits) {
    cudaStream_t stream = nullptr;
    ASSERT_EQ(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), cudaSuccess);
    int from = 1;
    int to = 0;
    cudaMemcpyAsync(&to, &from, sizeof(int), cudaMemcpyHostToDevice, stream);
    EXPECT_EQ(to, 0);
    from = 2;
    EXPECT_EQ(cudaStreamSynchronize(stream), cudaSuccess);
    EXPECT_EQ(to, 2) << "the source was still being read";
    cudaStreamDestroy(stream);
}

TEST(Runtime, AGraphDoesWhatTheStreamWasAskedForWheneverItIsLaunched) {
    cudaStream_t stream = nullptr;
    ASSERT_EQ(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), cudaSuccess);
    int from = 1;
    int to = 0;
    ASSERT_EQ(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), cudaSuccess);
    cudaMemcpyAsync(&to, &from, sizeof(int), cudaMemcpyHostToDevice, stream);
    EXPECT_EQ(cudaStreamSynchronize(stream), cudaErrorStreamCaptureUnsupported);
    cudaGraph_t graph = nullptr;
    cudaGraphExec_t executable = nullptr;
    ASSERT_EQ(cudaStreamEndCapture(stream, &graph), cudaSuccess);
    ASSERT_EQ(cudaGraphInstantiateWithFlags(&executable, graph, 0), cudaSuccess);
    EXPECT_EQ(cudaGraphDestroy(graph), cudaSuccess);
    EXPECT_EQ(cudaStreamSynchronize(stream), cudaSuccess);
    EXPECT_EQ(to, 0);
    for (const int value : {2, 3}) {
        from = value;
        EXPECT_EQ(cudaGraphLaunch(executable, stream), cudaSuccess);
        EXPECT_EQ(cudaStreamSynchronize(stream), cudaSuccess);
        EXPECT_EQ(to, value);
    }
    cudaGraphExecDestroy(executable);
    cudaStreamDestroy(stream);
}

TEST(Runtime, AnEventWithinAGraphTellsNoTimeUnlessItIsExternal) {
    cudaStream_t stream = nullptr;
    cudaEvent_t event = nullptr;
    cudaGraph_t graph = nullptr;
    float time = 0;
    cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking);
    cudaEventCreate(&event);
    EXPECT_EQ(cudaEventRecordWithFlags(event, stream, cudaEventRecordExternal), cudaErrorInvalidValue);
    cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal);
    EXPECT_EQ(cudaEventRecordWithFlags(event, stream, cudaEventRecordDefault), cudaSuccess);
    EXPECT_EQ(cudaEventElapsedTime(&time, event, event), cudaErrorCapturedEvent);
    EXPECT_EQ(cudaEventRecordWithFlags(event, stream, cudaEventRecordExternal), cudaSuccess);
    EXPECT_EQ(cudaEventElapsedTime(&time, event, event), cudaSuccess);
    cudaStreamEndCapture(stream, &graph);
    cudaGraphDestroy(graph);
    cudaEventDestroy(event);
    cudaStreamDestroy(stream);
}

}  // namespace
}  // namespace disparityd::test
