// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/recording/told_cameras.h"

#include <gtest/gtest.h>

namespace disparityd::tools {
namespace {

TEST(CamerasByCalibration, HaveTheLastOfEachAndForgetTheOldest) {
    CamerasByCalibration cameras;
    EXPECT_EQ(cameras.of(0), nullptr);
    cameras.take({.calibration_id = 7, .baseline_m = 0.1});
    cameras.take({.calibration_id = 7, .baseline_m = 0.2});
    ASSERT_NE(cameras.of(7), nullptr);
    EXPECT_EQ(cameras.of(7)->baseline_m, 0.2);
    const auto held = cameras.of(7);
    for (std::uint64_t id = 100; id < 100 + CamerasByCalibration::most; ++id) {
        cameras.take({.calibration_id = id});
    }
    EXPECT_EQ(cameras.of(7), nullptr);
    EXPECT_NE(cameras.of(100), nullptr);
    EXPECT_EQ(held->baseline_m, 0.2) << "what a frame uses stays";
}

}  // namespace
}  // namespace disparityd::tools
