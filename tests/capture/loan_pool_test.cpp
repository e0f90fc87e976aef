// SPDX-License-Identifier: Apache-2.0
#include "capture/loan_pool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace disparityd::capture {
namespace {

TEST(LoanPool, LendsEachBufferOnce) {
    LoanPool pool(3);
    std::vector<std::size_t> taken;
    while (pool.has_free() && taken.size() < 4) {
        taken.push_back(pool.take());
    }
    EXPECT_THAT(taken, ::testing::UnorderedElementsAre(0U, 1U, 2U));
}

TEST(LoanPool, LendsTheOneThatCameBackLast) {
    LoanPool pool(3);
    const std::size_t first = pool.take();
    const std::size_t second = pool.take();
    pool.give_back(second);
    pool.give_back(first);
    EXPECT_EQ(pool.take(), first);
    EXPECT_EQ(pool.take(), second);
}

TEST(LoanPool, WithoutBuffersHasNoneFree) {
    EXPECT_FALSE(LoanPool(0).has_free());
}

}  // namespace
}  // namespace disparityd::capture
