// SPDX-License-Identifier: Apache-2.0
// Every kernel of every instruction set of this machine against the reference, on random and hostile inputs.
#include <gtest/gtest.h>

#include "kernels/cpu/backend.h"
#include "tests/kernels/check/kernel_case.h"

namespace disparityd::test {
namespace {

MatchOptions any_options(Random& random, const KernelCase& kernel) {
    MatchOptions options;
    options.range = {pick(random, 0, 3) == 0 ? pick(random, -256, 256) : pick(random, -20, 20),
                     16 * pick(random, 1, 16)};
    options.sgm.p2 = pick(random, 0, 3) == 0 ? kernel.max_p2 : pick(random, 2, kernel.max_p2);
    options.sgm.p1 = pick(random, 1, options.sgm.p2 - 1);
    options.sgm.adaptive_p2 = pick(random, 0, 1) == 1;
    options.sgm.p2_slope = pick(random, 1, 8);
    options.sgm.p2_min = pick(random, 0, 2) == 0 ? pick(random, 0, options.sgm.p2) : 0;
    options.post.subpixel = pick(random, 0, 3) > 0;
    options.post.local_extrema = pick(random, 0, 1) == 1;
    options.post.uniqueness = pick(random, 0, 1) * pick(random, 0, 99);
    return options;
}

/// Odd sizes, widths around the lengths of vectors, single rows and columns, ranges wider than the image.
KernelInput any_input(Random& random, const KernelCase& kernel) {
    constexpr int around_vectors[] = {1, 2, 15, 16, 17, 31, 32, 33, 47, 48, 49, 63, 64, 65, 127, 128, 129};
    KernelInput input;
    input.seed = static_cast<unsigned>(random());
    const int kind = pick(random, 0, 2);
    input.width = kind == 0   ? around_vectors[pick(random, 0, 16)]
                  : kind == 1 ? pick(random, 1, 40)
                              : pick(random, 1, 220);
    input.height = pick(random, 1, 12);
    // Steps take little time: rows longer than what is worked on at once, and enough rows for several bands.
    if (kernel.name.starts_with("steps/") && pick(random, 0, 9) == 0) {
        input.width = pick(random, 505, 1040);
    } else if (kernel.name.starts_with("steps/") && pick(random, 0, 4) == 0) {
        input.height = pick(random, 13, 120);
    }
    input.options = any_options(random, kernel);
    return input;
}

struct CaseAndSet {
    KernelCase kernel;
    cpu::InstructionSet set;
};

/// For GoogleTest's messages, and the names that ctest gives to tests.
void PrintTo(const CaseAndSet& instance, std::ostream* to) {
    *to << instance.kernel.name << ' ' << instance.set.name;
}

std::vector<CaseAndSet> all_kernels() {
    std::vector<CaseAndSet> all;
    for (const KernelCase& kernel : kernel_cases()) {
        for (const cpu::InstructionSet& set : cpu::instruction_sets()) {
            all.push_back({kernel, set});
        }
    }
    return all;
}

class EveryKernel : public testing::TestWithParam<CaseAndSet> {};

TEST_P(EveryKernel, EqualsTheReference) {
    const auto& [kernel, set] = GetParam();
    Random random(100);
    constexpr int rounds = 60;
    for (int round = 0; round < rounds; ++round) {
        const KernelInput input = any_input(random, kernel);
        const KernelRun expected = kernel.bind(input, 0);
        const KernelRun found = kernel.bind(input, set.target);
        for (const KernelRun* run : {&expected, &found}) {
            if (run->prepare) {
                run->prepare();
            }
            run->run();
        }
        ASSERT_TRUE(found.intact()) << "wrote outside";
        ASSERT_TRUE(found.results() == expected.results())
            << "round " << round << ": " << input.width << "x" << input.height << ", D " << input.options.range.count
            << " from " << input.options.range.first << ", P1 " << input.options.sgm.p1 << ", P2 "
            << input.options.sgm.p2 << ", " << input.options.sgm.paths << " paths"
            << (input.options.sgm.adaptive_p2 ? " adaptive" : "");
    }
}

std::string name_of(const testing::TestParamInfo<CaseAndSet>& instance) {
    std::string name = instance.param.kernel.name + '_' + instance.param.set.name;
    std::replace(name.begin(), name.end(), '/', '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(Cpu, EveryKernel, testing::ValuesIn(all_kernels()), name_of);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(EveryKernel);

TEST(KernelCases, HaveNamesOfTheirOwn) {
    std::vector<std::string> names;
    for (const KernelCase& kernel : kernel_cases()) {
        names.push_back(kernel.name);
    }
    std::sort(names.begin(), names.end());
    EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

// A check that passes whatever a kernel does would be none.
TEST(KernelCases, ResultsAreWhatTheRunLeaves) {
    for (const KernelCase& kernel : kernel_cases()) {
        Random random(7);
        KernelInput input = any_input(random, kernel);
        input.width = 40;
        input.height = 8;
        input.options.range = {0, 16};
        input.hostile = false;
        const KernelRun run = kernel.bind(input, 0);
        const std::vector<std::uint8_t> before = run.results();
        if (run.prepare) {
            run.prepare();
        }
        run.run();
        EXPECT_NE(run.results(), before) << kernel.name;
    }
}

}  // namespace
}  // namespace disparityd::test
