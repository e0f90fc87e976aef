// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/kernels/support.h"

// The quality that the defaults were tuned to (docs/algorithm.md): at most the bad pixels of the paper's table 6.
namespace disparityd::test {
namespace {

struct Scene {
    const char* name;
    const char* folder;
    const char* images;  // extension
    const char* truth;
    const char* mask;
    int scale;
    int disparities;
    std::array<double, 3> max_bad;  // percent, of SAD, CENSUS and SGM
};

// What ctest lists; found by GoogleTest.
void PrintTo(const Scene& scene, std::ostream* out) {
    *out << scene.name;
}

constexpr std::array<Scene, 4> scenes = {
    {{"cones", "middlebury2003/cones", ".png", "disp_left.png", "mask_nonocc_derived.png", 4, 128, {18.3, 20.1, 6.9}},
     {"tsukuba", "middlebury2001/tsukuba", ".ppm", "disp_left.pgm", "mask_nonocc.png", 16, 32, {14.0, 12.2, 5.7}},
     {"teddy", "middlebury2003/teddy", ".png", "disp_left.png", "mask_nonocc_derived.png", 4, 128, {16.6, 18.2, 7.1}},
     {"sawtooth",
      "middlebury2001/sawtooth",
      ".ppm",
      "disp_left.pgm",
      "mask_nonocc_derived.png",
      8,
      32,
      {19.2, 20.1, 7.0}}}};

std::filesystem::path data_folder() {
    const char* const set = std::getenv("DISPARITYD_DATA");
    return set != nullptr ? set : DISPARITYD_SOURCE_DIR "/../shared/data";
}

Image<std::uint8_t> read(const std::filesystem::path& path) {
    const cv::Mat grey = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
    Image<std::uint8_t> image(grey.cols, grey.rows);
    for (int y = 0; y < grey.rows; ++y) {
        std::copy_n(grey.ptr(y), grey.cols, image.plane().row(y));
    }
    return image;
}

class Quality : public testing::TestWithParam<Scene> {};

TEST_P(Quality, IsAtLeastThatOfThePaper) {
    const Scene& scene = GetParam();
    const std::filesystem::path folder = data_folder() / scene.folder;
    if (!std::filesystem::exists(folder)) {
        GTEST_SKIP() << "no evaluation data: " << folder << " is not there (set DISPARITYD_DATA)";
    }
    const Image<std::uint8_t> left = read(folder / (std::string("left") + scene.images));
    const Image<std::uint8_t> right = read(folder / (std::string("right") + scene.images));
    const Image<std::uint8_t> truth = read(folder / scene.truth);
    const Image<std::uint8_t> mask = read(folder / scene.mask);
    ASSERT_GT(left.width(), 0);
    ASSERT_EQ(truth.pixels().size(), left.pixels().size());
    ASSERT_EQ(mask.pixels().size(), left.pixels().size());

    ShuffledWorkers workers(2, 1);
    for (const Method method : {Method::sad, Method::census, Method::sgm}) {
        MatchOptions options = default_options(method, {0, scene.disparities});
        options.post.subpixel = false;
        options.post.interpolate = true;
        options.post.min_texture = 0;
        const auto matcher = backend("auto").create({left.width(), left.height(), options});
        Frame frame(*matcher, left, right);
        match_pair(*matcher, frame.view, workers);
        int judged = 0;
        int bad = 0;
        for (std::size_t i = 0; i < mask.pixels().size(); ++i) {
            if (mask.pixels()[i] == 255) {
                const int found = frame.disparity.pixels()[i];
                const int error = std::abs(found * scene.scale - 16 * truth.pixels()[i]);
                ++judged;
                bad += found == invalid_disparity(options.range) || error > 16 * scene.scale ? 1 : 0;
            }
        }
        ASSERT_GT(judged, 10000);
        const double percent = 100.0 * bad / judged;
        EXPECT_LE(percent, scene.max_bad[static_cast<std::size_t>(method)]) << to_string(method);
        RecordProperty(std::string(to_string(method)), std::to_string(percent));
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Quality, testing::ValuesIn(scenes),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace disparityd::test
