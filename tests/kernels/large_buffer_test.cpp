// SPDX-License-Identifier: Apache-2.0
#include "kernels/large_buffer.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

namespace disparityd {
namespace {

constexpr std::size_t large_page = std::size_t{2} << 20;
const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));

TEST(LargeBuffer, ZeroedAndWritableToItsEnd) {
    for (const std::size_t size :
         {std::size_t{1}, std::size_t{4097}, large_page - 1, large_page, large_page + 1, 3 * large_page + 12345}) {
        const LargeBuffer buffer(size);
        ASSERT_EQ(buffer.size(), size);
        EXPECT_TRUE(
            std::all_of(buffer.data(), buffer.data() + size, [](std::byte value) { return value == std::byte{0}; }));
        std::fill_n(buffer.data(), size, std::byte{0xa5});
        EXPECT_EQ(buffer.data()[size - 1], std::byte{0xa5});
    }
}

TEST(LargeBuffer, BeginsWithALargePage) {
    for (const std::size_t size : {large_page, large_page + 1, 5 * large_page - 1}) {
        const LargeBuffer first(size), second(size);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(first.data()) % large_page, 0U);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(second.data()) % large_page, 0U);
    }
}

TEST(LargeBuffer, WhatAllHoldIsCounted) {
    const std::size_t before = large_memory_held();
    {
        LargeBuffer first(large_page + 1);
        EXPECT_EQ(large_memory_held() - before, 2 * large_page);
        const LargeBuffer moved(std::move(first));
        LargeBuffer small(1000);
        EXPECT_EQ(large_memory_held() - before, 2 * large_page + 1000);
        small = LargeBuffer();
        EXPECT_EQ(large_memory_held() - before, 2 * large_page);
    }
    EXPECT_EQ(large_memory_held(), before);
}

/// Returns how many pages of a buffer the system has given.
std::size_t resident_pages(const LargeBuffer& buffer) {
    std::vector<unsigned char> pages((buffer.size() + page - 1) / page);
    EXPECT_EQ(mincore(buffer.data(), buffer.size(), pages.data()), 0);
    return static_cast<std::size_t>(std::count_if(pages.begin(), pages.end(), [](auto held) { return held & 1; }));
}

/// Returns whether the system says that it has given memory and has not: an emulator of processors does.
bool system_only_says_so() {
    constexpr int populate_write = 23;
    void* const memory = mmap(nullptr, page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    unsigned char held = 0;
    const bool said = madvise(memory, page, populate_write) == 0;
    mincore(memory, page, &held);
    munmap(memory, page);
    return said && (held & 1) == 0;
}

TEST(LargeBuffer, AllThatAreThereGetTheirMemoryAtOnce) {
    if (system_only_says_so()) {
        GTEST_SKIP() << "an emulator does not pass on what is asked of memory";
    }
    const LargeBuffer large(3 * large_page + 5000), small(5 * page);
    large.data()[7] = std::byte{42};
    EXPECT_LT(resident_pages(small), 5U);
    fault_in_large_memory();
    EXPECT_EQ(resident_pages(large), 3 * large_page / page + (5000 + page - 1) / page);
    EXPECT_EQ(resident_pages(small), 5U);
    EXPECT_EQ(large.data()[7], std::byte{42}) << "what they hold stays";
    EXPECT_EQ(large.data()[8], std::byte{0});
}

TEST(LargeBuffer, Moves) {
    LargeBuffer first(large_page + 1);
    std::byte* const data = first.data();
    LargeBuffer second(std::move(first));
    EXPECT_EQ(second.data(), data);
    LargeBuffer third;
    EXPECT_EQ(third.data(), nullptr);
    third = std::move(second);
    EXPECT_EQ(third.data(), data);
    EXPECT_EQ(third.size(), large_page + 1);
    data[large_page] = std::byte{1};
}

TEST(LargeBuffer, ARefusalSaysHowMuchWasWanted) {
    EXPECT_EQ(LargeBuffer(0).data(), nullptr);
    try {
        const LargeBuffer buffer(std::numeric_limits<std::size_t>::max() / 4);
        FAIL() << "so much memory cannot be had";
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("4611686018428 MB"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace disparityd
