// SPDX-License-Identifier: Apache-2.0
#include "pipeline/distance_limits.h"

#include <cmath>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace disparityd::pipeline {
namespace {

using testing::HasSubstr;

constexpr int all_disparities = 1040;  // one for each disparity of the range, from -1 px on
constexpr DisparityRange searched{0, 64};
constexpr std::int64_t scale_k = 16 * 100 * 120;  // f = 100 px, 120 mm

/// A row that has each disparity once.
class Row {
public:
    Row()
        : disparity_(all_disparities),
          confidence_(all_disparities, 200),
          depth_(all_disparities, 7),
          error_(all_disparities, 8) {
        for (int x = 0; x < all_disparities; ++x) {
            disparity_[index(x)] = disparity_at(x);
        }
    }

    static std::int16_t disparity_at(int x) { return static_cast<std::int16_t>(x - 16); }

    void run(DistanceLimitStage& stage, const DepthScale& scale) {
        FrameView view;
        view.depth_scale = scale;
        view.disparity = {disparity_.data(), all_disparities, 1, all_disparities};
        view.confidence = {confidence_.data(), all_disparities, 1, all_disparities};
        view.depth = {depth_.data(), all_disparities, 1, all_disparities};
        view.depth_error = {error_.data(), all_disparities, 1, all_disparities};
        Serial serial;
        stage.run({.view = view, .memory = {}, .up = {}}, serial);
    }

    bool served(int x) const {
        const std::size_t i = index(x);
        const bool kept = disparity_[i] == disparity_at(x) && confidence_[i] == 200 && depth_[i] == 7 && error_[i] == 8;
        const bool rejected = disparity_[i] == -16 && confidence_[i] == 0 && depth_[i] == 0 && error_[i] == 0;
        EXPECT_TRUE(kept || rejected) << x;
        return kept;
    }

private:
    static std::size_t index(int x) { return static_cast<std::size_t>(x); }

    std::vector<std::int16_t> disparity_;
    std::vector<std::uint8_t> confidence_;
    std::vector<std::uint16_t> depth_;
    std::vector<std::uint16_t> error_;
};

/// Compares with the distance of each disparity, computed apart: nothing where it has none.
void expect_served(const DistanceLimits& limits, int offset16) {
    DistanceLimitStage stage(limits, searched);
    Row row;
    row.run(stage, {scale_k, offset16});
    for (int x = 0; x < all_disparities; ++x) {
        const double n = Row::disparity_at(x) + offset16;
        const double mm = n > 0 ? std::floor(static_cast<double>(scale_k) / n + 0.5) : 1e12;
        const bool within = mm >= 1000 * limits.min_m && (limits.max_m == 0 || mm <= 1000 * limits.max_m);
        ASSERT_EQ(row.served(x), within) << "d16 = " << Row::disparity_at(x) << ", " << mm << " mm";
    }
}

TEST(DistanceLimits, RejectWhatIsNearerOrFartherAndNothingElse) {
    for (const int offset16 : {0, 5, -40}) {
        expect_served({0.5, 4}, offset16);
        expect_served({0.25, 0}, offset16);
        expect_served({0, 10}, offset16);
        expect_served({192.0 / 500, 192.0 / 500}, offset16);  // whole millimetres of one disparity
    }
}

TEST(DistanceLimits, WithoutACalibrationNothingIsRejected) {
    DistanceLimitStage stage({0.5, 4}, searched);
    Row row;
    row.run(stage, {0, 0});
    for (int x = 0; x < all_disparities; ++x) {
        ASSERT_TRUE(row.served(x));
    }
    EXPECT_THAT(stage.notice(), HasSubstr("no calibration"));
    row.run(stage, {scale_k, 0});
    EXPECT_EQ(stage.notice(), "");
}

// 63 px are 0.19 m.
TEST(DistanceLimits, SayWhereTheyChangeNothingOrLeaveNothing) {
    const auto notice = [](const DistanceLimits& limits, int offset16 = 0) {
        DistanceLimitStage stage(limits, searched);
        EXPECT_EQ(stage.notice(), "");
        Row row;
        row.run(stage, {scale_k, offset16});
        return stage.notice();
    };
    EXPECT_EQ(notice({0.3, 30}), "");
    EXPECT_THAT(notice({0.15, 30}), HasSubstr("min_distance_m has no effect"));
    EXPECT_THAT(notice({0, 0.15}), HasSubstr("leave nothing"));
    EXPECT_THAT(notice({0, 30}, 160), HasSubstr("max_distance_m has no effect")) << "1.2 m are the farthest";
    EXPECT_THAT(notice({0.1, 30}, 160), HasSubstr("max_distance_m have no effect"));
    EXPECT_THAT(notice({20, 30}, 160), HasSubstr("leave nothing"));
}

}  // namespace
}  // namespace disparityd::pipeline
