// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <cuda_runtime.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/emulation/with_settings.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SIMT_ADDRESS_SANITIZER 1
#endif
#endif

// Kernels with a mistake each, as people make them: the emulation must tell.
namespace disparityd::test {
namespace {

using simt::Order;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::array<unsigned char, 2> poisons = {0x00, 0xa5};

std::string refusal(dim3 block, const std::function<void()>& kernel) {
    try {
        simt::run(dim3(2), block, 0, kernel);
    } catch (const simt::BrokenKernel& broken) {
        return broken.what();
    }
    return "not noticed";
}

TEST(DivergentBarriers, AThreadThatEndsBeforeTheBarrier) {
    const std::string found = refusal(dim3(40), [] {
        if (threadIdx.x < 33) {
            __syncthreads();
        }
    });
    EXPECT_THAT(found, AllOf(HasSubstr("not at the same barrier"), HasSubstr("detectors_test.cpp")));
}

TEST(DivergentBarriers, TwoBranchesWithABarrierEach) {
    // Not within a macro's arguments: all of those are on one line.
    const auto kernel = [] {
        if (threadIdx.x < 32) {
            __syncthreads();
        } else {
            __syncthreads();
        }
    };
    EXPECT_THAT(refusal(dim3(64), kernel), HasSubstr("not at the same barrier"));
}

TEST(DivergentBarriers, ALaneThatDoesNotComeToTheShuffle) {
    EXPECT_THAT(refusal(dim3(32),
                        [] {
                            if (threadIdx.x != 17) {
                                __shfl_xor_sync(0xffffffff, 1, 1);
                            }
                        }),
                HasSubstr("lane 17"));
    EXPECT_THAT(refusal(dim3(32),
                        [] {
                            if (threadIdx.x != 17) {
                                __reduce_min_sync(0xffffffff, 1U);
                            } else {
                                __syncthreads();
                            }
                        }),
                AllOf(HasSubstr("lane 17"), HasSubstr("barrier")));
}

TEST(DivergentBarriers, LanesThatDisagreeAboutWhoTakesPart) {
    EXPECT_THAT(refusal(dim3(32), [] { __ballot_sync(threadIdx.x < 16 ? 0xffffffff : 0xffff0000, 1); }),
                HasSubstr("lanes that do not come"));
    EXPECT_THAT(refusal(dim3(32), [] { __ballot_sync(0xffff, 1); }), HasSubstr("is not in the mask"));
    EXPECT_THAT(refusal(dim3(20), [] { __ballot_sync(0xffffffff, 1); }), HasSubstr("does not exist"));
}

TEST(DivergentBarriers, TwoBranchesWithAnOperationEach) {
    const auto kernel = [] {
        if (threadIdx.x % 2 == 0) {
            __any_sync(0xffffffff, 1);
        } else {
            __all_sync(0xffffffff, 1);
        }
    };
    EXPECT_THAT(refusal(dim3(32), kernel), HasSubstr("which waits at"));
}

TEST(DivergentBarriers, AShuffleFromALaneThatTakesNoPart) {
    EXPECT_THAT(refusal(dim3(32),
                        [] {
                            if (threadIdx.x < 8) {
                                __shfl_sync(0xff, 1, 9);
                            }
                        }),
                HasSubstr("takes no part"));
}

TEST(DivergentBarriers, ABlockWithTooManyThreads) {
    EXPECT_THAT(refusal(dim3(1025), [] {}), HasSubstr("1025"));
}

/// The outputs of a kernel in all orders and with two poisons; one means that the kernel is sound as far as can be
/// seen.
std::set<std::vector<int>> outcomes(int threads, const std::function<void(std::vector<int>&)>& kernel) {
    std::set<std::vector<int>> all;
    for (const Order order : {Order::ascending, Order::descending, Order::shuffled}) {
        for (const unsigned char poison : poisons) {
            const WithSettings settings{{order, 5, poison, false}};
            std::vector<int> out(static_cast<std::size_t>(threads));
            simt::run(dim3(1), dim3(static_cast<unsigned>(threads)), 0, [&] { kernel(out); });
            all.insert(out);
        }
    }
    return all;
}

// Each thread passes a value to the one beside it in its warp.
template <typename Barrier>
void pass_on(std::vector<int>& out, Barrier barrier) {
    auto& values = simt::shared<int[64]>([] {});
    values[threadIdx.x] = static_cast<int>(threadIdx.x);
    barrier();
    out[threadIdx.x] = values[threadIdx.x ^ 1];
}

TEST(MissingBarriers, BetweenLanesOfOneWarp) {
    EXPECT_GT(outcomes(64, [](std::vector<int>& out) { pass_on(out, [] {}); }).size(), 1U);
    EXPECT_EQ(outcomes(64, [](std::vector<int>& out) { pass_on(out, [] { __syncwarp(); }); }).size(), 1U);
}

TEST(MissingBarriers, BetweenWarps) {
    const auto reverse = [](std::vector<int>& out, bool block_wide) {
        auto& values = simt::shared<int[64]>([] {});
        values[threadIdx.x] = static_cast<int>(threadIdx.x);
        if (block_wide) {
            __syncthreads();
        } else {
            __syncwarp();
        }
        out[threadIdx.x] = values[63 - threadIdx.x];
    };
    EXPECT_GT(outcomes(64, [&](std::vector<int>& out) { reverse(out, false); }).size(), 1U);
    EXPECT_EQ(outcomes(64, [&](std::vector<int>& out) { reverse(out, true); }).size(), 1U);
}

TEST(MissingBarriers, BeforeSharedMemoryIsUsedAgain) {
    const auto twice = [](std::vector<int>& out, bool second_barrier) {
        auto& values = simt::shared<int[64]>([] {});
        for (int round = 0; round < 2; ++round) {
            values[threadIdx.x] = static_cast<int>(threadIdx.x) + 100 * round;
            __syncthreads();
            out[threadIdx.x] += values[63 - threadIdx.x];
            if (second_barrier) {
                __syncthreads();
            }
        }
    };
    EXPECT_GT(outcomes(64, [&](std::vector<int>& out) { twice(out, false); }).size(), 1U);
    EXPECT_EQ(outcomes(64, [&](std::vector<int>& out) { twice(out, true); }).size(), 1U);
}

TEST(MissingAtomics, LostUpdatesShowWhenOthersTakeTurnsBetween) {
    // Read, then write what was read plus one: an atomic that is none.
    const auto count = [](bool atomically) {
        const WithSettings settings{{Order::ascending, 1, 0, true}};
        unsigned total = 0;
        unsigned other = 0;
        simt::run(dim3(1), dim3(64), 0, [&] {
            if (atomically) {
                atomicAdd(&total, 1U);
                return;
            }
            const unsigned read = total;
            atomicAdd(&other, 1U);
            total = read + 1;
        });
        return total;
    };
    EXPECT_LT(count(false), 64U);
    EXPECT_EQ(count(true), 64U);
}

TEST(UnwrittenMemory, IsSeenInTheOutputOfTwoPoisons) {
    const auto sum = [](std::vector<int>& out, unsigned written) {
        auto& values = simt::shared<int[64]>([] {});
        if (threadIdx.x < written) {
            values[threadIdx.x] = 1;
        }
        __syncthreads();
        out[threadIdx.x] = values[63 - threadIdx.x];
    };
    EXPECT_GT(outcomes(64, [&](std::vector<int>& out) { sum(out, 63); }).size(), 1U);
    EXPECT_EQ(outcomes(64, [&](std::vector<int>& out) { sum(out, 64); }).size(), 1U);
}

TEST(UnwrittenMemory, OfTheDeviceIsPoisonedToo) {
    for (const unsigned char poison : poisons) {
        const WithSettings settings{{Order::ascending, 1, poison, false}};
        void* memory = nullptr;
        ASSERT_EQ(cudaMalloc(&memory, 16), cudaSuccess);
        EXPECT_EQ(static_cast<unsigned char*>(memory)[15], poison);
        EXPECT_EQ(cudaFree(memory), cudaSuccess);
    }
}

// The second block goes on with what the first one leaves, as far as it waits for it.
int handed_over(bool waits) {
    simt::Settings settings;
    settings.resident_blocks = 2;
    const WithSettings these(settings);
    std::array<int, 2> shared = {};  // a value, and whether it is there
    int found = 0;
    simt::run(dim3(2), dim3(1), 0, [&] {
        const auto* there = static_cast<volatile int*>(&shared[1]);
        if (blockIdx.x == 0) {
            __syncthreads();
            __syncthreads();
            shared = {7, 1};
        } else {
            while (waits && *there == 0) {
                __nanosleep(10);
            }
            found = shared[0];
        }
    });
    return found;
}

TEST(BlocksAtTheSameTime, WhoDoesNotWaitForAnotherBlockFindsNothing) {
    EXPECT_EQ(handed_over(true), 7);
    EXPECT_EQ(handed_over(false), 0);
}

TEST(BlocksAtTheSameTime, WaitingForABlockThatCannotBeginIsRefused) {
    // The first block waits for the second one, which begins when the first has ended.
    const std::string found = refusal(dim3(32), [value = std::make_shared<int>(0)] {
        *value += static_cast<int>(blockIdx.x);
        while (*static_cast<volatile int*>(value.get()) == 0) {
            __nanosleep(10);
        }
    });
    EXPECT_THAT(found, AllOf(HasSubstr("waits for what no running thread writes"), HasSubstr("detectors_test.cpp")));
}

#ifdef SIMT_ADDRESS_SANITIZER

void read_device_memory(std::size_t index) {
    void* memory = nullptr;
    void* neighbour = nullptr;
    cudaMalloc(&memory, 64 * sizeof(int));
    cudaMalloc(&neighbour, 64 * sizeof(int));
    int sum = 0;
    simt::run(dim3(1), dim3(1), 0, [&] { sum += static_cast<volatile int*>(memory)[index]; });
    cudaFree(memory);
    cudaFree(neighbour);
}

TEST(OutOfBoundsDeathTest, OneElementBehindDeviceMemory) {
    read_device_memory(63);
    EXPECT_DEATH(read_device_memory(64), "heap-buffer-overflow");
}

void write_shared_memory(unsigned index) {
    simt::run(dim3(1), dim3(32), 0, [=] {
        auto& values = simt::shared<int[32]>([] {});
        static_cast<volatile int*>(values)[index + threadIdx.x] = 1;
        __syncthreads();
    });
}

TEST(OutOfBoundsDeathTest, OneElementBehindSharedMemory) {
    write_shared_memory(0);
    EXPECT_DEATH(write_shared_memory(1), "heap-buffer-overflow");
}

// Where no compiler can see how large the array is.
__attribute__((noinline)) void set(volatile int* values, int index) {
    values[index] = 1;
}

TEST(OutOfBoundsDeathTest, AnArrayOnTheStackOfAThread) {
    const auto write = [](int index) {
        simt::run(dim3(1), dim3(32), 0, [=] {
            volatile int values[4] = {};
            __syncthreads();
            set(values, index);
            __syncthreads();
        });
    };
    write(3);
    EXPECT_DEATH(write(4), "stack-buffer-overflow");
}

#endif

}  // namespace
}  // namespace disparityd::test
