// SPDX-License-Identifier: Apache-2.0
#include "trust/judge.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "kernels/near_plane.h"
#include "proto/doubt.h"
#include "tests/trust/textured_pair.h"

namespace disparityd::trust {
namespace {

using test::TexturedPair;

constexpr int rate = 15;

/// Passes frames of a scene that moves to a judge, as a camera would.
class JudgeTest : public testing::Test {
protected:
    using Change = std::function<void(TexturedPair&, int moved)>;

    /// Returns what is said of the last of the frames.
    Verdict see(
        double seconds, const Change& change = [](TexturedPair&, int) {}) {
        Verdict verdict;
        for (int i = 0; i < std::lround(seconds * rate); ++i) {
            const int moved = 3 * (frame_ % 20);
            TexturedPair pair = drawn(frame_ % 20);
            change(pair, moved);
            verdict = judge_.judge(pair.view(), frame_ * 1'000'000'000LL / rate, frame_ == 0);
            ++frame_;
        }
        return verdict;
    }

    static const TexturedPair& drawn(int index) {
        static const std::vector<TexturedPair> pairs = [] {
            std::vector<TexturedPair> list;
            for (int i = 0; i < 20; ++i) {
                list.emplace_back(3 * i);
            }
            return list;
        }();
        return pairs[static_cast<std::size_t>(index)];
    }

    static void fill(std::vector<std::uint8_t>& eye, std::uint8_t level) { std::fill(eye.begin(), eye.end(), level); }

    static void scale(std::vector<std::uint8_t>& eye, int part) {
        std::transform(eye.begin(), eye.end(), eye.begin(),
                       [part](std::uint8_t level) { return static_cast<std::uint8_t>(level / part); });
    }

    static void blur_right(TexturedPair& pair, int /*moved*/) {
        TexturedPair::blur(pair.right, 0, 0, TexturedPair::width, TexturedPair::height, 2);
    }
    static void blur_spot(TexturedPair& pair, int /*moved*/) { TexturedPair::blur(pair.left, 90, 40, 170, 120); }
    static void lower_by_one(TexturedPair& pair, int moved) { pair.lower_right_eye(1, moved); }
    static void cover_left(TexturedPair& pair, int /*moved*/) { fill(pair.left, 70); }

    Judge judge_{TexturedPair::width, TexturedPair::height, {}};
    int frame_ = 0;
};

TEST_F(JudgeTest, AGoodPairIsTrusted) {
    const Verdict verdict = see(6);
    EXPECT_EQ(verdict.doubts, 0U);
    EXPECT_EQ(verdict.trust, 255);
}

TEST_F(JudgeTest, AFrameThatWasMatchedForNoiseIsNoisy) {
    TexturedPair pair = drawn(0);
    FrameView view = pair.view();
    view.noise_level = 1;
    const Verdict verdict = judge_.judge(view, 0, true);
    EXPECT_EQ(verdict.doubts, proto::doubt_noisy);
    EXPECT_EQ(verdict.trust, 255 * 12 / 16);
}

TEST_F(JudgeTest, ACoveredEyeIsNamedWithinASecond) {
    see(2);
    const Verdict verdict = see(1, cover_left);
    EXPECT_EQ(verdict.doubts, proto::doubt_covered_eye);
    EXPECT_LT(verdict.trust, 32);
}

// A hand that passes by is no fault of the camera.
TEST_F(JudgeTest, AnEyeThatIsCoveredForTwoFramesIsNotNamed) {
    see(2);
    EXPECT_EQ(see(2.0 / rate, cover_left).doubts, 0U);
    EXPECT_EQ(see(1).doubts, 0U);
}

TEST_F(JudgeTest, ACoveredEyeThatIsFreeAgainIsTrustedAgain) {
    see(2, cover_left);
    EXPECT_EQ(see(2).doubts, 0U);
}

TEST_F(JudgeTest, ABlurredLensIsNamedWithinFiveSeconds) {
    see(2);
    EXPECT_EQ(see(5, blur_right).doubts, proto::doubt_blurred);
}

TEST_F(JudgeTest, ADirtyEyeIsNamedWithinFiveSeconds) {
    see(2);
    EXPECT_EQ(see(5, blur_spot).doubts, proto::doubt_dirty_eye);
}

TEST_F(JudgeTest, DirtOfTheRightEyeIsFoundToo) {
    see(2);
    const auto blur = [](TexturedPair& pair, int) { TexturedPair::blur(pair.right, 90, 40, 170, 120); };
    EXPECT_EQ(see(5, blur).doubts, proto::doubt_dirty_eye);
}

// Where nothing is measured, nothing says where the left picture shows it; it is still there.
TEST_F(JudgeTest, DirtOfTheRightEyeStaysWhereItIsNotSeen) {
    const auto cells = [this] { return std::count(judge_.dirty_cells().begin(), judge_.dirty_cells().end(), true); };
    const auto blur = [](TexturedPair& pair, int) { TexturedPair::blur(pair.right, 90, 40, 170, 120); };
    see(7, blur);
    const Cells<bool> seen = judge_.dirty_cells();
    ASSERT_GT(cells(), 3);
    // Each window ends with a frame in which nothing is measured.
    const auto blind_at_its_end = [&](TexturedPair& pair, int moved) {
        blur(pair, moved);
        if (frame_ % (rate + 1) == rate) {
            fill(pair.confidence, 0);
        }
    };
    see(4, blind_at_its_end);
    EXPECT_EQ(judge_.dirty_cells(), seen);
    EXPECT_EQ(see(9, blind_at_its_end).doubts & proto::doubt_dirty_eye, proto::doubt_dirty_eye);
    EXPECT_EQ(judge_.dirty_cells(), seen);
    see(2, blur);
    EXPECT_EQ(judge_.dirty_cells(), seen);
}

TEST_F(JudgeTest, WhatMovesIsNoDirt) {
    see(2);
    const auto blur = [](TexturedPair& pair, int moved) {
        TexturedPair::blur(pair.left, 4 * moved, 40, 4 * moved + 80, 120);
    };
    EXPECT_EQ(see(5, blur).doubts, 0U);
}

// Nothing can be said of a place where the other eye sees a white wall.
TEST_F(JudgeTest, WhatIsPlainForBothEyesIsNoDirt) {
    const auto plain = [](TexturedPair& pair, int) {
        TexturedPair::blur(pair.left, 90, 40, 170, 120);
        TexturedPair::blur(pair.right, 90 - TexturedPair::disparity, 40, 170 - TexturedPair::disparity, 120);
    };
    EXPECT_EQ(see(6, plain).doubts, 0U);
}

// The edge of what rectification leaves black is no texture that the other eye lacks.
TEST_F(JudgeTest, WhatRectificationLeavesBlackIsNoDirt) {
    const auto cut = [](int slope, int least) {
        return [slope, least](TexturedPair& pair, int) {
            for (int y = 3 * TexturedPair::height / 4; y < TexturedPair::height; ++y) {
                for (int x = 0; x < TexturedPair::width; ++x) {
                    pair.left[TexturedPair::at(x, y)] = 150;
                    const bool seen = y < TexturedPair::height - least - x * slope / TexturedPair::width;
                    pair.right[TexturedPair::at(x, y)] = seen ? std::uint8_t{150} : std::uint8_t{0};
                }
            }
        };
    };
    EXPECT_EQ(see(6, cut(0, 0)).doubts, 0U) << "a plain floor";
    EXPECT_EQ(see(6, cut(14, 4)).doubts, 0U) << "with a black wedge below it";
    EXPECT_EQ(see(6, cut(0, 1)).doubts, 0U) << "or a row, in one eye";
}

TEST_F(JudgeTest, RowsThatDoNotFitAreNamedWithinFiveSeconds) {
    see(2);
    EXPECT_EQ(see(5, lower_by_one).doubts, proto::doubt_misaligned);
}

TEST_F(JudgeTest, AFaultIsForgottenSomeSecondsAfterItsEnd) {
    see(5, lower_by_one);
    EXPECT_EQ(see(1).doubts, proto::doubt_misaligned);
    EXPECT_EQ(see(4).doubts, 0U);
}

TEST_F(JudgeTest, ANewSceneForgetsFaultsAtOnce) {
    see(5, lower_by_one);
    TexturedPair pair;
    EXPECT_EQ(judge_.judge(pair.view(), 0, true).doubts, 0U);
}

TEST_F(JudgeTest, ADarkSceneIsDoubtedAtOnce) {
    const auto darken = [](TexturedPair& pair, int) {
        scale(pair.left, 16);
        scale(pair.right, 16);
    };
    EXPECT_EQ(see(1.0 / rate, darken).doubts, proto::doubt_dark);
}

TEST_F(JudgeTest, TheOptionSaysWhatIsDark) {
    judge_ = Judge(TexturedPair::width, TexturedPair::height, {.dark_level = 5});
    const auto darken = [](TexturedPair& pair, int) {
        scale(pair.left, 16);
        scale(pair.right, 16);
    };
    EXPECT_EQ(see(1.0 / rate, darken).doubts, 0U);
}

TEST_F(JudgeTest, TheOptionSaysHowManyRowsAreAllowed) {
    judge_ = Judge(TexturedPair::width, TexturedPair::height, {.rows_px = 1.5});
    EXPECT_EQ(see(5, lower_by_one).doubts, 0U);
}

TEST_F(JudgeTest, AWhiteSkyIsDoubtedAtOnce) {
    const auto whiten = [](TexturedPair& pair, int) {
        std::fill_n(pair.left.begin(), pair.left.size() / 3, std::uint8_t{255});
    };
    EXPECT_EQ(see(1.0 / rate, whiten).doubts, proto::doubt_saturated);
}

TEST_F(JudgeTest, AThingThatIsTooNearIsDoubtedAtOnce) {
    TexturedPair pair;
    FrameView view = pair.view();
    std::vector<std::int16_t> near(400, not_near);
    view.near = {near.data(), 20, 20, 20};
    std::fill_n(near.begin(), 19, std::int16_t{1000});
    EXPECT_EQ(judge_.judge(view, 0, true).doubts, 0U);
    near[19] = 1000;
    EXPECT_EQ(judge_.judge(view, 0, true).doubts, proto::doubt_too_near);
}

TEST_F(JudgeTest, TrustFallsWithTheShareThatIsMeasured) {
    const auto reject = [](TexturedPair& pair, int) {
        std::fill_n(pair.confidence.begin(), pair.confidence.size() * 7 / 10, std::uint8_t{0});
    };
    const Verdict verdict = see(1, reject);
    EXPECT_EQ(verdict.doubts, 0U);
    EXPECT_NEAR(verdict.trust, 127, 8);
}

// As where a recording begins anew.
TEST_F(JudgeTest, TimesThatJumpBackBeginAWindow) {
    see(2);
    frame_ = 0;
    EXPECT_EQ(see(5, lower_by_one).doubts, proto::doubt_misaligned);
}

// Pictures of a folder may have no times.
TEST_F(JudgeTest, FramesAtOneTimeAreJudgedByTheirNumber) {
    Verdict verdict;
    for (int i = 0; i < 401; ++i) {
        TexturedPair pair;
        pair.lower_right_eye(1);
        verdict = judge_.judge(pair.view(), 0, false);
    }
    EXPECT_EQ(verdict.doubts, proto::doubt_misaligned);
}

TEST(Judge, ASmallImageIsNotJudged) {
    std::vector<std::uint8_t> eye(32 * 16);
    FrameView view;
    view.left = view.right = {eye.data(), 32, 16, 32};
    const Verdict verdict = Judge(32, 16, {}).judge(view, 0, true);
    EXPECT_EQ(verdict.doubts, 0U);
    EXPECT_EQ(verdict.trust, 0);
}

}  // namespace
}  // namespace disparityd::trust
