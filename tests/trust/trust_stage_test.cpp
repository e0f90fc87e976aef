// SPDX-License-Identifier: Apache-2.0
#include "trust/trust_stage.h"

#include <vector>

#include <gtest/gtest.h>

#include "proto/doubt.h"
#include "tests/trust/textured_pair.h"

namespace disparityd::trust {
namespace {

using test::TexturedPair;

/// Runs a stage and returns its records as bytes.
std::vector<std::byte> records(int frames, bool discontinuity_at_end) {
    TrustStage stage(TexturedPair::width, TexturedPair::height, {});
    std::vector<std::byte> memory(stage.bytes_per_frame() * static_cast<std::size_t>(frames));
    Serial serial;
    for (int i = 0; i < frames; ++i) {
        TexturedPair pair(i % 20);
        pair.lower_right_eye(1, i % 20);
        stage.run({.view = pair.view(),
                   .memory = std::span(memory).subspan(static_cast<std::size_t>(i) * stage.bytes_per_frame(),
                                                       stage.bytes_per_frame()),
                   .monotonic_ns = i * 66'666'667LL,
                   .discontinuity = discontinuity_at_end && i + 1 == frames,
                   .up = {}},
                  serial);
    }
    return memory;
}

TEST(TrustStage, TheRecordIsTheVerdict) {
    const std::vector<std::byte> memory = records(60, false);
    const Verdict last = verdict_of(std::span(memory).last(sizeof(Verdict)));
    EXPECT_EQ(last.doubts, proto::doubt_misaligned);
    EXPECT_GT(last.trust, 0);
    EXPECT_EQ(verdict_of(memory).doubts, 0U);
}

/// Returns what is said after ten seconds in which the robot's arm, dull and too near to be matched, is in view of both
/// eyes.
std::uint32_t doubts_with_arm(bool masked) {
    const auto is_arm = [](int x, int y) { return x >= 120 && x < 200 && y >= 100; };
    std::vector<std::uint8_t> mask(std::size_t{TexturedPair::width} * TexturedPair::height);
    const auto for_arm = [&](auto use) {
        for (int y = 0; y < TexturedPair::height; ++y) {
            for (int x = 0; x < TexturedPair::width; ++x) {
                if (is_arm(x, y)) {
                    use(x, y);
                }
            }
        }
    };
    for_arm([&](int x, int y) { mask[TexturedPair::at(x, y)] = 1; });
    TrustStage stage(TexturedPair::width, TexturedPair::height, {},
                     {masked ? mask.data() : nullptr, TexturedPair::width, TexturedPair::height, TexturedPair::width});
    std::vector<std::byte> memory(stage.bytes_per_frame());
    Serial serial;
    for (int i = 0; i < 150; ++i) {
        TexturedPair pair(i % 20);
        for_arm([&](int x, int y) {
            pair.left[TexturedPair::at(x, y)] = 30;
            pair.right[TexturedPair::at(x - 60, y)] = 30;
            pair.confidence[TexturedPair::at(x, y)] = 0;
        });
        stage.run({.view = pair.view(), .memory = memory, .monotonic_ns = i * 66'666'667LL, .up = {}}, serial);
    }
    return verdict_of(memory).doubts;
}

TEST(TrustStage, AMaskedPartOfTheRobotIsNoDirt) {
    EXPECT_EQ(doubts_with_arm(false), proto::doubt_dirty_eye);
    EXPECT_EQ(doubts_with_arm(true), 0U);
}

TEST(TrustStage, ADiscontinuityBeginsAnew) {
    const std::vector<std::byte> memory = records(60, true);
    EXPECT_EQ(verdict_of(std::span(memory).last(sizeof(Verdict))).doubts, 0U);
}

}  // namespace
}  // namespace disparityd::trust
