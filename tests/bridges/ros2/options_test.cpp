// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/options.h"

#include <stdexcept>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>

namespace disparityd::ros2 {
namespace {

using testing::HasSubstr;

Options parsed(const std::string& line) {
    CLI::App app("", "disparity-ros2");
    Options options;
    options.add_to(app);
    app.parse(line);
    return options;
}

std::string refusal(const std::string& line) {
    try {
        const Options options = parsed(line);
        options.settings();
        options.node();
    } catch (const std::invalid_argument& error) {
        return error.what();
    } catch (const CLI::ParseError& error) {
        return error.what();
    }
    return {};
}

TEST(Ros2Options, WithoutOptionsMessagesAreReliableAndCloudsAreLight) {
    const BridgeSettings settings = parsed("").settings();
    EXPECT_TRUE(settings.quality.reliable);
    EXPECT_FALSE(settings.quality.transient_local);
    EXPECT_EQ(settings.encoding.cloud.most_points, 20000U);
    EXPECT_EQ(settings.encoding.names.left, "stereo_left_optical_frame");
    EXPECT_EQ(settings.encoding.hidden, ros::HiddenSpace::obstacle);
    EXPECT_EQ(settings.encoding.depth_codec, ros::DepthCodec::png);
    EXPECT_TRUE(settings.publishes_tf);
    EXPECT_EQ(parsed("").node().name_space, "/stereo");
}

TEST(Ros2Options, EachReachesItsPlace) {
    const Options options = parsed(
        "--camera-name front --names zed --reliability best-effort --durability transient-local --depth 2 "
        "--parent-frame base_link --height-m 0.5 --scan-frame base_footprint --points packed --points-box "
        "0.2,5,-2,2.5,-0.3,1.5 --points-voxel-m 0.05 --scan-hidden ignored --compressed-depth rvl");
    const BridgeSettings settings = options.settings();
    EXPECT_FALSE(settings.quality.reliable);
    EXPECT_TRUE(settings.quality.transient_local);
    EXPECT_EQ(settings.quality.depth, 2);
    EXPECT_EQ(settings.tree.parent, "base_link");
    EXPECT_EQ(settings.tree.place.height_m, 0.5);
    EXPECT_FALSE(settings.tree.places_the_scan);
    EXPECT_EQ(settings.encoding.names.scan, "base_footprint");
    EXPECT_EQ(settings.encoding.names.left, "front_left_camera_frame_optical");
    EXPECT_EQ(settings.encoding.hidden, ros::HiddenSpace::ignored);
    EXPECT_EQ(settings.encoding.depth_codec, ros::DepthCodec::rvl);
    EXPECT_TRUE(settings.encoding.cloud.packed);
    EXPECT_EQ(settings.encoding.cloud.box->left_to, 2.5);
    EXPECT_EQ(settings.encoding.cloud.voxel_m, 0.05);
    EXPECT_EQ(options.node().name_space, "/front/zed_node");
    EXPECT_FALSE(parsed("--no-tf").settings().publishes_tf);
}

TEST(Ros2Options, WhatIsWrongIsOneLine) {
    EXPECT_THAT(refusal("--camera-name front-left"),
                HasSubstr("--camera-name: found \"front-left\", allowed: a letter"));
    EXPECT_THAT(refusal("--namespace /a//b"), HasSubstr("--namespace: found \"/a//b\""));
    EXPECT_THAT(refusal("--node-name 2x"), HasSubstr("--node-name"));
    EXPECT_THAT(refusal("--parent-frame 'base link'"), HasSubstr("--parent-frame"));
    EXPECT_THAT(refusal("--no-tf --parent-frame base_link"),
                HasSubstr("--parent-frame: found \"base_link\", allowed: no place of the camera with --no-tf"));
    EXPECT_THAT(refusal("--height-m 0.3"), HasSubstr("no --parent-frame"));
    EXPECT_THAT(refusal("--points-box 1,2,3"), HasSubstr("six numbers"));
    EXPECT_THAT(refusal("--points-box 1,2,3,4,5,6,7"), HasSubstr("three pairs"));
    EXPECT_THAT(refusal("--points-box 2,1,3,4,5,6"), HasSubstr("from less to more"));
    EXPECT_THAT(refusal("--depth 0"), HasSubstr("allowed: 1 .. 1000"));
    EXPECT_THAT(refusal("--reliability sometimes"), HasSubstr("best-effort"));
    EXPECT_THAT(refusal("--compressed-depth jpeg"), HasSubstr("rvl"));
    EXPECT_EQ(refusal("--namespace /"), "");
}

TEST(Ros2Options, FramesAreNamedAsTf2HasThem) {
    EXPECT_EQ(refusal("--parent-frame base-link"), "");
    EXPECT_EQ(refusal("--parent-frame base_link --scan-frame base_link"), "") << "the scan has the robot's origin";
    EXPECT_EQ(refusal("--parent-frame stereo_footprint --scan-frame stereo_footprint"), "");
    EXPECT_THAT(refusal("--parent-frame /base_link"), HasSubstr("--parent-frame: found \"/base_link\""));
    EXPECT_THAT(refusal("--scan-frame /base_link"), HasSubstr("--scan-frame: found \"/base_link\""));
    for (const char* own : {"stereo_link", "stereo_left_optical_frame", "stereo_right_optical_frame", "stereo_imu_link",
                            "stereo_footprint"}) {
        EXPECT_THAT(refusal(std::string("--parent-frame ") + own), HasSubstr("own")) << own;
    }
    EXPECT_EQ(refusal("--parent-frame stereo_link --camera-name front"), "");
}

TEST(Ros2Options, OfLargeMessagesFewAreKept) {
    const Quality quality = parsed("--durability transient-local --depth 1000").settings().quality;
    for (const ros::Content large : {ros::Content::left_image, ros::Content::left_jpeg, ros::Content::depth,
                                     ros::Content::disparity, ros::Content::points}) {
        EXPECT_EQ(quality_for(large, quality).depth, 10) << static_cast<int>(large);
        EXPECT_EQ(quality_for(large, {.depth = 2}).depth, 2);
    }
    EXPECT_EQ(quality_for(ros::Content::imu, quality).depth, 1000);
    EXPECT_EQ(quality_for(ros::Content::scan, quality).depth, 1000);
    EXPECT_TRUE(quality_for(ros::Content::depth, quality).transient_local);
}

}  // namespace
}  // namespace disparityd::ros2
