// SPDX-License-Identifier: Apache-2.0
#include "calibration/board/verdict.h"

#include <gmock/gmock.h>

#include "calibration/board/coverage.h"
#include "calibration/board/other_board.h"
#include "capture/scene/scene_camera.h"
#include "tests/calibration/board/drawn_board.h"

namespace disparityd::calibration::verdict {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr int width = 640;
constexpr int height = 360;
const Board board{9, 6, 30};

std::vector<std::uint8_t> picture_of(const Board& shown, const test::Pose& pose) {
    return test::BoardPainter(capture::scene_calibration(width, height), shown).draw(pose);
}

Plane<const std::uint8_t> left_of(const std::vector<std::uint8_t>& picture) {
    return {picture.data(), width, height, 2 * width};
}

const std::vector<BoardView>& careful_views() {
    static const std::vector<BoardView> views = test::careful_views(board, width, height);
    return views;
}

/// A view whose corners are the outline of a rectangle, the right eye's `shift` px farther left.
BoardView outline(float x, float y, float right, float bottom, float shift) {
    BoardView view{{{x, y}, {right, y}, {x, bottom}, {right, bottom}}, {}, {0, 8, 45, 53}};
    for (const cv::Point2f& corner : view.left) {
        view.right.emplace_back(corner.x - shift, corner.y);
    }
    return view;
}

TEST(Coverage, CountsWhatLiesWithinTheOutlines) {
    // A quarter of the image, then the same quarter again and an eighth more.
    const Coverage once = coverage_of({outline(0, 0, 320, 180, 0)}, width, height);
    EXPECT_NEAR(once.left.ratio, 0.25, 0.01);
    EXPECT_THAT(once.left.parts, ElementsAre(true, true, false, true, true, false, false, false, false));
    const Coverage twice = coverage_of({outline(0, 0, 320, 180, 0), outline(160, 0, 480, 180, 160)}, width, height);
    EXPECT_NEAR(twice.left.ratio, 0.375, 0.01);
    EXPECT_NEAR(twice.right.ratio, 0.25, 0.01) << "the right eye sees both at the same place";
    EXPECT_EQ(coverage_of({}, width, height).right.ratio, 0);
}

TEST(Coverage, IsNamedByTheEyeThatLacksIt) {
    const auto missing = missing_views({outline(420, 10, 630, 350, 210)}, board, width, height);
    EXPECT_THAT(missing, Contains("hold the board into the left part of the image"));
    EXPECT_THAT(missing, Contains("hold the board into the upper right part of the right eye's image"));
    EXPECT_THAT(missing, Not(Contains("hold the board into the upper right part of the left eye's image")));
}

TEST(MissingViews, TellWhereTheBoardWasNot) {
    EXPECT_TRUE(missing_views(careful_views(), board, width, height).empty())
        << missing_views(careful_views(), board, width, height)[0];
    const auto none = missing_views({}, board, width, height);
    EXPECT_EQ(none.size(), 9U + 2);
    const auto view = outline(20, 10, 200, 110, 10);
    const auto some = missing_views({view}, board, width, height);
    EXPECT_THAT(some, Contains(HasSubstr("lower right")));
    EXPECT_THAT(some, testing::Not(Contains(HasSubstr("upper left"))));
    EXPECT_THAT(some, Contains(HasSubstr("nearer")));
    EXPECT_THAT(some, Contains(HasSubstr("0 of 3 views")));
}

TEST(Verdict, IsGoodForCarefulViews) {
    const BoardCalibration found = calibrate(careful_views(), board, width, height);
    EXPECT_THAT(bad_views(found, 3), IsEmpty());
    const Judgement judgement = judge(found, careful_views(), board);
    EXPECT_STREQ(to_string(judgement.verdict), "good") << testing::PrintToString(judgement.reasons);
    EXPECT_THAT(judgement.reasons, IsEmpty());
}

TEST(Verdict, NamesWhatIsNotGood) {
    BoardCalibration found = calibrate(careful_views(), board, width, height);
    found.rms = 0.7;
    Judgement judgement = judge(found, careful_views(), board);
    EXPECT_STREQ(to_string(judgement.verdict), "usable");
    EXPECT_THAT(judgement.reasons, ElementsAre(HasSubstr("0.70 px from where")));
    for (auto& view : found.views) {
        view.rows = 0.6;
    }
    judgement = judge(found, careful_views(), board);
    EXPECT_STREQ(to_string(judgement.verdict), "repeat");
    EXPECT_THAT(judgement.reasons, Contains(HasSubstr("0.60 px apart after rectification")));
    const std::vector<BoardView> few(careful_views().begin(), careful_views().begin() + 4);
    judgement = judge(calibrate(few, board, width, height), few, board);
    EXPECT_STREQ(to_string(judgement.verdict), "repeat");
    EXPECT_THAT(judgement.reasons, Contains(HasSubstr("4 views were used, 10 are good")));
    EXPECT_THAT(judgement.reasons, Contains(HasSubstr("have no corner")));
}

TEST(Verdict, BadViewsAreLeftOutAndTheOthersDecide) {
    std::vector<BoardView> views = careful_views();
    ASSERT_GE(views.size(), 8U);
    // One eye misread by a few pixels, as of a board that moved between the exposures; and a blurred one.
    for (std::size_t i = 0; i < views[3].right.size(); ++i) {
        views[3].right[i].y += 3;
        views[6].left[i].x += i % 2 == 0 ? 1.5F : -1.5F;
    }
    const BoardCalibration with = calibrate(views, board, width, height);
    const CheckedCalibration checked = calibrate_and_judge(views, board, width, height, BoardLens::brown, false);
    ASSERT_EQ(checked.left_out.size(), 2U);
    EXPECT_EQ(checked.left_out[0].view, 3U);
    EXPECT_EQ(checked.left_out[1].view, 6U);
    EXPECT_EQ(checked.used.size(), views.size() - 2);
    EXPECT_EQ(checked.views.size(), checked.found.views.size());
    EXPECT_LT(checked.found.rms, 0.2);
    EXPECT_GT(with.rms, 2 * checked.found.rms);
    const CheckedCalibration all = calibrate_and_judge(views, board, width, height, BoardLens::brown, true);
    EXPECT_THAT(all.left_out, IsEmpty());
    EXPECT_EQ(all.found.rms, with.rms);
}

TEST(Verdict, BadViewsAreTheWorstOfThoseThatStandOut) {
    BoardCalibration found;
    for (int i = 0; i < 8; ++i) {
        found.views.push_back({0.1, i < 3 ? 2.0 + i : 0.1, 0.1});
    }
    EXPECT_THAT(bad_views(found, 2), ElementsAre(1, 2)) << "the worst two";
    EXPECT_THAT(bad_views(found, 8), ElementsAre(0, 1, 2));
    found.views.pop_back();
    EXPECT_THAT(bad_views(found, 8), IsEmpty()) << "too few to say which are wrong";
}

TEST(OtherBoard, IsNamedOnceEnoughFramesShowIt) {
    const test::Pose pose{{0.1, -0.2, 0.05}, {-90, -70, 700}};
    const auto seven = picture_of({7, 5, 30}, pose);
    OtherBoard other(board, 2);
    other.look_at(left_of(seven));
    EXPECT_EQ(other.finding(), "");
    other.look_at(left_of(seven));
    EXPECT_EQ(other.finding(), "the board has 7 x 5 inner corners, not 9 x 6: --columns 7 --rows 5");
}

TEST(OtherBoard, IsToldByItsMarkers) {
    const Board charuco{6, 4, 40, BoardMarkers{marker_family("5x5"), 0.75}};
    const auto marked = picture_of(charuco, {{0, 0, 0}, {-120, -80, 600}});
    const auto plain = picture_of(board, {{0, 0, 0}, {-120, -80, 600}});
    const auto finding = [](const Board& expected, const std::vector<std::uint8_t>& picture) {
        OtherBoard other(expected, 1);
        other.look_at(left_of(picture));
        return other.finding();
    };
    EXPECT_THAT(finding(board, marked), HasSubstr("--board charuco --dictionary 5x5"));
    EXPECT_THAT(finding({6, 4, 40, BoardMarkers{marker_family("4x4"), 0.75}}, marked), HasSubstr("of 5x5, not of 4x4"));
    EXPECT_THAT(finding({5, 4, 40, BoardMarkers{marker_family("5x5"), 0.75}}, marked),
                HasSubstr("count --columns and --rows"));
    EXPECT_THAT(finding(charuco, plain), HasSubstr("the board has no markers"));
    EXPECT_EQ(finding(board, plain), "");
    EXPECT_EQ(finding(board, std::vector<std::uint8_t>(2 * width * height, 90)), "");
    // A wrong number of columns gives the corners wrong places: that is no view.
    const Plane<const std::uint8_t> right{marked.data() + width, width, height, 2 * width};
    EXPECT_TRUE(find_board(left_of(marked), right, charuco));
    EXPECT_FALSE(find_board(left_of(marked), right, {5, 4, 40, BoardMarkers{marker_family("5x5"), 0.75}}));
    EXPECT_FALSE(find_board(left_of(marked), right, {7, 4, 40, BoardMarkers{marker_family("5x5"), 0.75}}));
}

}  // namespace
}  // namespace disparityd::calibration::verdict
