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

TEST(TrustStage, ADiscontinuityBeginsAnew) {
    const std::vector<std::byte> memory = records(60, true);
    EXPECT_EQ(verdict_of(std::span(memory).last(sizeof(Verdict))).doubts, 0U);
}

}  // namespace
}  // namespace disparityd::trust
