// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/stereo_advice.h"

#include <gtest/gtest.h>

#include "capture/camera/camera_uri.h"

namespace disparityd::capture {
namespace {

CameraSurvey webcam(std::vector<VideoMode> modes) {
    CameraSurvey survey;
    survey.camera.node = "/dev/video0";
    survey.camera.name = "3D USB Camera";
    survey.modes = std::move(modes);
    return survey;
}

/// The URI that is proposed; empty when there is none. Whatever is proposed can be opened.
std::string proposed(const CameraSurvey& survey) {
    const auto advice = advise(survey);
    if (!advice) {
        return "";
    }
    const CameraRequest request = parse_camera_uri(advice->uri);
    EXPECT_EQ(request.eye_width(), advice->eye_width);
    EXPECT_EQ(request.eye_height(), advice->eye_height);
    return advice->uri;
}

TEST(StereoAdvice, ACameraWhoseFrameIsTwoUsualPicturesIsOne) {
    const CameraSurvey cheap = webcam({{"MJPG", 3840, 1080, {30}},
                                       {"MJPG", 2560, 960, {60, 30}},
                                       {"MJPG", 2560, 720, {30}},
                                       {"MJPG", 1280, 480, {60}},
                                       {"YUYV", 2560, 720, {5}},
                                       {"YUYV", 640, 480, {30}}});
    EXPECT_EQ(proposed(cheap), "v4l2:2560x960@30?device=/dev/video0&format=mjpeg");
    EXPECT_EQ(advise(cheap)->reason, "2560x960 is two pictures of 4:3 side by side");
    CameraSurvey fixed = cheap;
    fixed.camera.port = "1-2.3";
    EXPECT_EQ(proposed(fixed), "v4l2:2560x960@30?port=1-2.3&format=mjpeg");
}

TEST(StereoAdvice, PixelsComeBeforeJpegsWhereTheyAreAsFast) {
    EXPECT_EQ(proposed(webcam({{"MJPG", 1280, 480, {60, 30}}, {"YUYV", 1280, 480, {30}}})),
              "v4l2:1280x480@30?device=/dev/video0");
    EXPECT_EQ(proposed(webcam({{"GREY", 1280, 480, {}}})), "v4l2:1280x480@30?device=/dev/video0&format=grey");
    EXPECT_EQ(proposed(webcam({{"YUYV", 2560, 720, {10, 5}}, {"YUYV", 640, 240, {20}}})),
              "v4l2:2560x720@10?device=/dev/video0");
    EXPECT_EQ(proposed(webcam({{"MJPG", 4416, 1242, {15}}, {"MJPG", 3840, 1080, {29.97}}})),
              "v4l2:3840x1080@29.97?device=/dev/video0&format=mjpeg");
}

TEST(StereoAdvice, OtherCamerasAreNone) {
    for (const auto& [width, height] :
         {std::pair{640, 480}, {1920, 1080}, {1280, 800}, {2560, 1080}, {3440, 1440}, {720, 1280}, {640, 0}}) {
        EXPECT_EQ(proposed(webcam({{"YUYV", width, height, {30}}})), "") << width << 'x' << height;
    }
    EXPECT_EQ(proposed(webcam({{"H264", 2560, 720, {30}}})), "") << "a format that is not read";
    EXPECT_EQ(proposed(webcam({})), "");
    CameraSurvey busy = webcam({{"YUYV", 2560, 720, {30}}});
    busy.problem = "in use";
    EXPECT_EQ(proposed(busy), "");
}

TEST(StereoAdvice, AZedIsTakenByItsNumberAndWhatItsLinkHas) {
    CameraSurvey zed = webcam({{"YUYV", 4416, 1242, {15}}, {"YUYV", 2560, 720, {60, 30}}, {"YUYV", 1344, 376, {100}}});
    zed.camera.vendor = zed_vendor;
    zed.camera.product = 0xf780;
    zed.camera.serial = "12345";
    EXPECT_EQ(proposed(zed), "v4l2:hd720@30?serial=12345");
    EXPECT_EQ(advise(zed)->reason, "a ZED 2");
    zed.modes.erase(zed.modes.begin(), zed.modes.begin() + 2);
    EXPECT_EQ(proposed(zed), "v4l2:vga@30?serial=12345");
}

TEST(StereoAdvice, TwoCamerasThatAreAlikeMayBeTheEyes) {
    CameraSurvey left = webcam({{"MJPG", 1920, 1080, {30}}, {"MJPG", 1280, 720, {30}}, {"YUYV", 640, 480, {30}}});
    CameraSurvey right = left;
    right.camera.node = "/dev/video2";
    const auto uris = [](const std::vector<CameraSurvey>& surveys) {
        std::vector<std::string> list;
        for (const PairAdvice& pair : advise_pairs(surveys)) {
            const CameraRequest request = parse_camera_uri(pair.advice.uri);
            EXPECT_EQ(request.eye_width(), pair.advice.eye_width);
            EXPECT_EQ(request.eye_height(), pair.advice.eye_height);
            list.push_back(pair.advice.uri);
        }
        return list;
    };
    using Uris = std::vector<std::string>;
    EXPECT_EQ(uris({left, right}), Uris{"v4l2:1280x720@30?left=/dev/video0&right=/dev/video2&format=mjpeg"});
    EXPECT_EQ(advise_pairs({left, right})[0].advice.reason, "both are 3D USB Camera and offer 1280x720");
    left.camera.port = "1-1.1";
    right.camera.port = "1-1.2";
    right.modes.erase(right.modes.begin(), right.modes.begin() + 2);
    EXPECT_EQ(uris({left, right}), Uris{"v4l2:640x480@30?left=port:1-1.1&right=port:1-1.2"}) << "what both offer";
    CameraSurvey third = left;
    third.camera.node = "/dev/video4";
    EXPECT_EQ(uris({left, right, third}), Uris{}) << "any two of three";
    third.camera.name = "another";
    EXPECT_EQ(uris({left, third, right}).size(), 1U);
    right.camera.bus = 2;
    EXPECT_EQ(uris({left, right}), Uris{});
    right.camera.bus = 0;
    right.problem = "in use";
    EXPECT_EQ(uris({left, right}), Uris{});
    EXPECT_EQ(uris({webcam({{"YUYV", 1280, 480, {30}}}), webcam({{"YUYV", 1280, 480, {30}}})}), Uris{})
        << "two stereo cameras";
}

}  // namespace
}  // namespace disparityd::capture
