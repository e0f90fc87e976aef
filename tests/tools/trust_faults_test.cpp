// SPDX-License-Identifier: Apache-2.0
//
// One made sequence of each fault, and a good one: what disparity-eval --trust counts in thirty of each.
#include <stdexcept>

#include <gmock/gmock.h>

#include "tools/eval/trust/trust_report.h"

namespace disparityd::test {
namespace {

using eval::Fault;

eval::TrustCount count_one(Fault fault) {
    eval::TrustEvaluation evaluation;
    evaluation.seed = 2;
    evaluation.sequences = 1;
    evaluation.match = preset_options(Preset::obstacles);
    evaluation.backend = &backend("cpu");
    Serial serial;
    return eval::count_trust(evaluation, fault, serial);
}

TEST(TrustFaults, EachIsNamedWithinFiveSecondsAndNoOther) {
    for (const Fault fault : eval::faults) {
        const eval::TrustCount count = count_one(fault);
        EXPECT_EQ(count.named, 1) << name(fault);
        EXPECT_EQ(count.others, 0) << name(fault);
        EXPECT_THAT(count.missed, testing::IsEmpty());
    }
}

TEST(TrustFaults, GoodEyesRaiseNoAlarm) {
    EXPECT_EQ(count_one(Fault::none).others, 0);
}

TEST(TrustFaults, DataIsASeedOrPairs) {
    EXPECT_EQ(eval::seed_of_faults({"faults:7"}), 7U);
    EXPECT_EQ(eval::seed_of_faults({"left.png,right.png"}), std::nullopt);
    for (const char* wrong : {"faults:", "faults:-1", "faults:1.5", "faults:x"}) {
        EXPECT_THROW(eval::seed_of_faults({wrong}), std::invalid_argument) << wrong;
    }
    EXPECT_THROW(eval::seed_of_faults({"faults:1", "more"}), std::invalid_argument);
}

}  // namespace
}  // namespace disparityd::test
