// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/topics.h"

#include <set>

#include <gmock/gmock.h>

#include "bridges/ros_messages/encode.h"
#include "bridges/ros_messages/static_transforms.h"

namespace disparityd::ros {
namespace {

using testing::Contains;

std::set<std::string> names(Naming naming, const std::string& name_space, bool clock = false) {
    std::set<std::string> list;
    for (const Topic& topic : all_topics(naming, name_space, clock)) {
        EXPECT_TRUE(list.insert(topic.name).second) << topic.name << " is there twice";
        EXPECT_FALSE(message_name(topic.content).empty()) << topic.name;
    }
    return list;
}

TEST(Ros2Topics, TwoTablesNameThem) {
    const std::set<std::string> pipeline = names(Naming::image_pipeline, "/stereo");
    for (const char* name : {"/stereo/left/image_rect", "/stereo/right/camera_info", "/stereo/disparity",
                             "/stereo/points2", "/stereo/depth/image_rect_raw/compressedDepth"}) {
        EXPECT_THAT(pipeline, Contains(name));
    }
    EXPECT_THAT(pipeline, Contains("/stereo/imu/data_raw"));
    EXPECT_THAT(pipeline, testing::Not(Contains("/stereo/imu/data"))) << "it has no orientation";
    const std::set<std::string> zed = names(Naming::zed, default_namespace(Naming::zed, "zed"));
    for (const char* name : {"/zed/zed_node/left/color/rect/image", "/zed/zed_node/left/color/rect/camera_info",
                             "/zed/zed_node/depth/depth_registered", "/zed/zed_node/point_cloud/cloud_registered",
                             "/zed/zed_node/depth/depth_registered/compressedDepth", "/zed/zed_node/imu/data"}) {
        EXPECT_THAT(zed, Contains(name));
    }
}

TEST(Ros2Topics, ANamespaceMayBeWrittenInSeveralWays) {
    EXPECT_THAT(names(Naming::image_pipeline, "robot/front"), Contains("/robot/front/left/image_rect"));
    EXPECT_THAT(names(Naming::image_pipeline, "/"), Contains("/left/image_rect"));
    EXPECT_THAT(names(Naming::image_pipeline, "/a", true), Contains("/clock"));
    EXPECT_THAT(names(Naming::image_pipeline, "/a"), testing::Not(Contains("/clock")));
}

TEST(Ros2Topics, TwoCamerasHaveNothingInCommonButDiagnostics) {
    const std::set<std::string> one = names(Naming::image_pipeline, default_namespace(Naming::image_pipeline, "a"));
    for (const std::string& name : names(Naming::image_pipeline, default_namespace(Naming::image_pipeline, "b"))) {
        EXPECT_EQ(one.contains(name), name == "/diagnostics") << name;
    }
}

TEST(Ros2Topics, NamesAreThoseThatRosAllows) {
    for (const char* good : {"a", "_a", "front_2", "A1"}) {
        EXPECT_TRUE(is_ros_name(good)) << good;
    }
    for (const char* bad : {"", "2a", "a-b", "a/b", "a__b", "a b", "ä"}) {
        EXPECT_FALSE(is_ros_name(bad)) << bad;
    }
    for (const char* good : {"", "/", "/a", "a", "/a/b", "a/b"}) {
        EXPECT_TRUE(is_ros_namespace(good)) << good;
    }
    for (const char* bad : {"//", "/a/", "/a//b", "~/a", "/a-b", "/1"}) {
        EXPECT_FALSE(is_ros_namespace(bad)) << bad;
    }
    for (const char* good : {"base_link", "base-link", "robot/base.1", "2"}) {
        EXPECT_TRUE(is_frame_name(good)) << good;
    }
    for (const char* bad : {"", "/base_link", "base_link/", "base link", "<x>", "/"}) {
        EXPECT_FALSE(is_frame_name(bad)) << bad;
    }
}

TEST(Ros2StaticTransforms, ACameraAloneIsTheRoot) {
    const TreeOfFrames tree{.names = frame_names(Naming::image_pipeline, "s"), .right = "s_right_optical_frame"};
    const std::vector<Transform> transforms = static_transforms(tree, 0.12, std::nullopt);
    ASSERT_EQ(transforms.size(), 2U);
    EXPECT_EQ(transforms[0], (Transform{"s_link", "s_left_optical_frame", {}, optical_to_robot}));
    EXPECT_EQ(transforms[1], (Transform{"s_link", "s_right_optical_frame", {0, -0.12, 0}, optical_to_robot}));
    EXPECT_EQ(static_transforms(tree, 0, std::nullopt).size(), 1U) << "without a calibration";
}

TEST(Ros2StaticTransforms, AParentHasTheCameraAndTheGroundBelowIt) {
    TreeOfFrames tree{
        .names = frame_names(Naming::image_pipeline, "s"), .parent = "base_link", .place = {0.1, 0.2, 0.3}};
    const std::vector<Transform> transforms = static_transforms(tree, 0, std::nullopt);
    ASSERT_EQ(transforms.size(), 3U);
    EXPECT_EQ(transforms[0], (Transform{"base_link", "s_link", {0.1, 0.2, 0.3}}));
    EXPECT_EQ(transforms[1], (Transform{"base_link", "s_footprint", {0.1, 0.2, 0}}));
    tree.places_the_scan = false;
    EXPECT_EQ(static_transforms(tree, 0, std::nullopt).size(), 2U);
}

TEST(Ros2StaticTransforms, AYawThatTheDaemonMustHaveTooIsSaid) {
    TreeOfFrames tree{
        .names = frame_names(Naming::image_pipeline, "s"), .parent = "base_link", .place = {.yaw_deg = 90}};
    EXPECT_THAT(yaw_of_scans_text(tree), testing::HasSubstr("s_footprint has the axes of base_link"));
    tree.places_the_scan = false;
    EXPECT_EQ(yaw_of_scans_text(tree), "");
    tree.places_the_scan = true;
    tree.place.yaw_deg = 0;
    EXPECT_EQ(yaw_of_scans_text(tree), "");
}

TEST(Ros2StaticTransforms, TheSensorIsWhereTheCalibrationSays) {
    const TreeOfFrames tree{.names = frame_names(Naming::zed, "z")};
    const disparity::InertialPose pose{{0, 0, 1, 1, 0, 0, 0, 1, 0}, {10, -20, 30}};
    const Transform last = static_transforms(tree, 0, pose).back();
    EXPECT_EQ(last,
              (Transform{"z_left_camera_frame_optical", "z_imu_link", {0.01, -0.02, 0.03}, {0.5, 0.5, 0.5, 0.5}}));
}

// A point p of the raw eye is turn p in the rectified one, which is what a transform from the latter to the former
// says.
TEST(Ros2StaticTransforms, TheRawEyeIsTurnedAsRectificationSays) {
    const TreeOfFrames tree{.names = frame_names(Naming::image_pipeline, "s")};
    const std::array<double, 9> turn{0, 0, 1, 1, 0, 0, 0, 1, 0};
    EXPECT_EQ(static_transforms(tree, 0, std::nullopt, turn).back(),
              (Transform{"s_left_optical_frame", "s_left_raw_optical_frame", {}, {0.5, 0.5, 0.5, 0.5}}));
}

}  // namespace
}  // namespace disparityd::ros
