// SPDX-License-Identifier: Apache-2.0
#include "tests/cuda/compare.h"
#include "tests/cuda/device_under_test.h"
#include "tests/emulation/with_settings.h"

namespace disparityd::test {
namespace {

// One frame, all orders and two poisons: no barrier is missing and nothing unwritten is read, as far as this data
// shows.
TEST(EmulatedCuda, OrderAndUnwrittenMemoryDoNotMatter) {
    Random random(54);
    const Pair pair(random, 35, 34);
    for (const auto& [method, cost] : methods_and_costs) {
        MatchOptions options = default_options(method, {-3, 32});
        options.cost = cost;
        options.post.speckle_size = 12;
        options.post.interpolate = true;
        const Result expected = result_of("reference", pair, options);
        for (int n = 0; n < 6; n += all_rounds ? 1 : 4) {
            const Variation variation(n);
            ASSERT_EQ(result_of("cuda", pair, options), expected)
                << to_string(method) << ", " << to_string(cost) << ", settings " << n;
        }
    }
}

// Strips of a sweep hand each other what stands at their edges, whoever else runs at the time.
TEST(EmulatedCuda, HoweverManyBlocksRunAtATimeTheStripsWaitForEachOther) {
    Random random(57);
    const Pair pair(random, 50, 18);
    MatchOptions options = default_options(Method::sgm, {-3, 16});
    const Result expected = result_of("reference", pair, options);
    for (const int blocks : {2, 100}) {
        simt::Settings settings;
        settings.order = simt::Order::shuffled;
        settings.seed = static_cast<unsigned>(blocks);
        settings.resident_blocks = blocks;
        const WithSettings these(settings);
        ASSERT_EQ(result_of("cuda", pair, options), expected) << blocks << " blocks";
    }
}

TEST(EmulatedCuda, AnIntegratedDeviceGivesTheSameWithMappedMemory) {
    Random random(55);
    simt::Machine jetson;
    jetson.integrated = true;
    for (int round = 0; round < 3; ++round) {
        const WithMachine machine(jetson);
        MatchOptions options = any_options(random);
        options.method = static_cast<Method>(round);
        expect_equal_to_reference(Pair(random, 35, 11), options);
    }
}

TEST(EmulatedCuda, ADriverWithoutGraphsGivesTheSame) {
    Random random(56);
    simt::Machine old;
    old.graphs = false;
    const WithMachine machine(old);
    for (const Method method : {Method::sad, Method::census, Method::sgm}) {
        expect_equal_to_reference(Pair(random, 20, 9), default_options(method, {0, 16}));
    }
}

}  // namespace
}  // namespace disparityd::test
