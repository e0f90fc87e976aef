// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/tools/named_causes.h"

namespace disparityd::empty_result {
namespace {

TEST(EmptyResultOfMany, NamesTheCauseOf27Of30) {
    for (const Kind& kind : kinds) {
        EXPECT_GE(rightly_named(kind, 1001, 30), 27) << kind.words;
    }
}

TEST(EmptyResultOfMany, TellsNothingOfGoodPairs) {
    expect_nothing_told_of_good_pairs(1001, 30);
}

}  // namespace
}  // namespace disparityd::empty_result
