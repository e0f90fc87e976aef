// SPDX-License-Identifier: Apache-2.0
//
// The depth of a camera that sends JPEGs is that of the same pixels in a folder of PNGs.
#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <opencv2/imgcodecs.hpp>

#include "calibration/rectification.h"
#include "capture/camera/camera_source.h"
#include "capture/scene/scene_camera.h"
#include "capture/scene/scene_render.h"
#include "kernels/large_buffer.h"
#include "kernels/matcher.h"
#include "kernels/parallel.h"
#include "lab/jpeg-load/yuyv_jpeg.h"
#include "tests/capture/camera/fake_camera.h"
#include "tests/capture/camera/made_jpeg.h"
#include "tests/temporary_folder.h"

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;

constexpr int scene_width = 160;
constexpr int scene_height = 96;

struct Matched {
    std::vector<std::int16_t> disparity;
    std::vector<std::uint8_t> confidence;
    std::vector<std::uint16_t> depth;

    bool operator==(const Matched&) const = default;
};

/// Rectifies and matches a frame of the scene's camera.
Matched match(const RawImage& raw) {
    constexpr std::size_t pixels = std::size_t{scene_width} * scene_height;
    const auto rectification =
        calibration::make_rectification(scene_calibration(scene_width, scene_height), scene_width, scene_height, {});
    const Rectifier rectifier = rectification.rectifier();
    const auto matcher = make_matcher("cpu", {scene_width, scene_height, default_options(Method::sgm, {0, 32})});
    const LargeBuffer scratch(matcher->scratch_bytes());
    Matched matched{std::vector<std::int16_t>(pixels), std::vector<std::uint8_t>(pixels),
                    std::vector<std::uint16_t>(pixels)};
    std::vector<std::uint8_t> left(pixels);
    std::vector<std::uint8_t> right(pixels);
    FrameView view;
    view.raw = raw;
    view.rectifier = &rectifier;
    view.depth_scale.k = 100'000;
    view.left = {left.data(), scene_width, scene_height, scene_width};
    view.right = {right.data(), scene_width, scene_height, scene_width};
    view.disparity = {matched.disparity.data(), scene_width, scene_height, scene_width};
    view.confidence = {matched.confidence.data(), scene_width, scene_height, scene_width};
    view.depth = {matched.depth.data(), scene_width, scene_height, scene_width};
    view.scratch = {scratch.data(), scratch.size()};
    Serial workers;
    for (std::size_t stage = 0; stage < matcher->stages().size(); ++stage) {
        std::vector<std::chrono::nanoseconds> times(matcher->stages()[stage].steps.size());
        matcher->run(static_cast<int>(stage), view, workers, times);
    }
    return matched;
}

/// The JPEGs of two frames of the scene.
std::vector<test::Bytes> scene_jpegs() {
    SceneOptions options;
    options.width = scene_width;
    options.height = scene_height;
    options.loop = 2;
    const SceneRenderer renderer(options);
    std::vector<test::Bytes> jpegs;
    for (int i = 0; i < 2; ++i) {
        test::Bytes frame(renderer.frame_bytes());
        renderer.render(i, frame.data(), [] {});
        jpegs.push_back(lab::jpeg_of(frame, 2 * scene_width, scene_height, 90));
    }
    return jpegs;
}

std::unique_ptr<FrameSource> open_camera_with(test::FakeVideoSystem& system, const std::vector<test::Bytes>& jpegs) {
    auto camera = test::zed2();
    camera.width = 2 * scene_width;
    camera.height = scene_height;
    camera.format = V4L2_PIX_FMT_MJPEG;
    camera.jpegs = jpegs;
    system.plug(camera);
    SourceOptions options;
    options.uri = "v4l2:320x96@30?format=mjpeg";
    options.decoders = 0;
    return open_camera_on(system, options);
}

TEST(JpegDepth, IsThatOfTheSamePixelsInAFolderOfPngs) {
    const disparityd::test::TemporaryFolder folder;
    const auto jpegs = scene_jpegs();
    for (std::size_t i = 0; i < jpegs.size(); ++i) {
        auto planes = test::planes_of(jpegs[i], 2 * scene_width, scene_height);
        const cv::Mat both(scene_height, 2 * scene_width, CV_8U, planes.luma.data());
        const std::string number = std::to_string(i) + ".png";
        ASSERT_TRUE(cv::imwrite(folder.file("left" + number), both.colRange(0, scene_width)));
        ASSERT_TRUE(cv::imwrite(folder.file("right" + number), both.colRange(scene_width, 2 * scene_width)));
    }
    SourceOptions options;
    options.uri = folder.file("left%d.png") + "," + folder.file("right%d.png");
    options.pace = Pace::fastest;
    const auto images = open_source(options);
    test::FakeVideoSystem system;
    const auto camera = open_camera_with(system, jpegs);
    for (std::size_t i = 0; i < jpegs.size(); ++i) {
        RawFrame sent;
        while (camera->next(sent, system.now() + 1s) != FrameSource::Next::frame) {
            ASSERT_LT(system.now().time_since_epoch(), 1h + 10s);
        }
        RawFrame read;
        ASSERT_EQ(images->next(read, std::chrono::steady_clock::now() + 1min), FrameSource::Next::frame);
        const Matched depth = match(sent.image);
        EXPECT_EQ(depth, match(read.image)) << "frame " << i;
        EXPECT_GT(std::count_if(depth.depth.begin(), depth.depth.end(), [](auto value) { return value > 0; }),
                  scene_width * scene_height / 4)
            << "something is measured";
        camera->give_back(sent);
        images->give_back(read);
    }
}

}  // namespace
}  // namespace disparityd::capture
