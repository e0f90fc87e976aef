// SPDX-License-Identifier: Apache-2.0
#include "trust/trust_stage.h"

#include <algorithm>
#include <memory>
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

/// Shows frames in which a part of one eye is blurred, and returns what is told of its dirt.
std::vector<PixelBox> dirt_of(std::vector<std::uint8_t> TexturedPair::*eye, TrustStage& stage,
                              const StageNotes& notes) {
    std::vector<std::byte> memory(stage.bytes_per_frame());
    Serial serial;
    for (int i = 0; i < 80; ++i) {
        TexturedPair pair(3 * (i % 20));
        TexturedPair::blur(pair.*eye, 90, 40, 170, 120);
        stage.run({.view = pair.view(), .memory = memory, .monotonic_ns = i * 66'666'667LL, .up = {}}, serial);
    }
    return notes.dirty;
}

bool covers(const std::vector<PixelBox>& boxes, int x, int y) {
    return std::any_of(boxes.begin(), boxes.end(), [&](const PixelBox& box) {
        return x >= box.first_x && x < box.end_x && y >= box.first_y && y < box.end_y;
    });
}

TEST(TrustStage, TellsTheScanWhereDirtIs) {
    for (const auto eye : {&TexturedPair::left, &TexturedPair::right}) {
        const auto notes = std::make_shared<StageNotes>();
        TrustStage stage(TexturedPair::width, TexturedPair::height, {}, {}, notes);
        const std::vector<PixelBox> dirt = dirt_of(eye, stage, *notes);
        const int centre = 130 + (eye == &TexturedPair::right ? TexturedPair::disparity : 0);
        EXPECT_TRUE(covers(dirt, centre, 80));
        EXPECT_FALSE(covers(dirt, centre - 80, 80));
        EXPECT_FALSE(covers(dirt, centre + 80, 80));
        EXPECT_FALSE(covers(dirt, centre, 180));
        std::vector<std::byte> memory(stage.bytes_per_frame());
        TexturedPair pair;
        Serial serial;
        stage.run({.view = pair.view(), .memory = memory, .discontinuity = true, .up = {}}, serial);
        EXPECT_TRUE(notes->dirty.empty()) << "a source that begins anew has no dirt yet";
    }
}

TEST(TrustStage, GroundThatIsNearIsNotTooNear) {
    const auto notes = std::make_shared<StageNotes>();
    TrustStage stage(TexturedPair::width, TexturedPair::height, {}, {}, notes);
    TexturedPair pair;
    FrameView view = pair.view();
    std::vector<std::int16_t> blocks(80 * 48, std::int16_t{900});
    view.near = {blocks.data(), 80, 48, 80};
    const auto doubts = [&](std::optional<std::ptrdiff_t> no_ground) {
        notes->near_blocks = no_ground;
        std::vector<std::byte> memory(stage.bytes_per_frame());
        Serial serial;
        stage.run({.view = view, .memory = memory, .discontinuity = true, .up = {}}, serial);
        return verdict_of(memory).doubts;
    };
    EXPECT_EQ(doubts(std::nullopt), proto::doubt_too_near);
    EXPECT_EQ(doubts(80 * 48 / 20 - 1), 0U);
    EXPECT_EQ(doubts(80 * 48 / 20), proto::doubt_too_near);
}

}  // namespace
}  // namespace disparityd::trust
