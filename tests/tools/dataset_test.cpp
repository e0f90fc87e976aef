// SPDX-License-Identifier: Apache-2.0
#include "tools/datasets/dataset.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"
#include "tests/data_folder.h"

namespace disparityd::datasets {
namespace {

using capture::test::numbered_image;
using capture::test::refusal;
using capture::test::TemporaryFolder;
using capture::test::write_file;
using capture::test::write_image;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr float unknown = std::numeric_limits<float>::infinity();

void write_pair(const TemporaryFolder& folder, const std::string& left, const std::string& right) {
    std::filesystem::create_directories(std::filesystem::path(folder.file(left)).parent_path());
    std::filesystem::create_directories(std::filesystem::path(folder.file(right)).parent_path());
    write_image(folder.file(left), numbered_image(3, 2, CV_8UC1, 1));
    write_image(folder.file(right), numbered_image(3, 2, CV_8UC1, 2));
}

std::string pfm_bytes(std::initializer_list<float> values, bool little) {
    std::string text;
    for (const float value : values) {
        const auto bits = std::bit_cast<std::uint32_t>(value);
        for (int i = 0; i < 4; ++i) {
            text += static_cast<char>(bits >> (8 * (little ? i : 3 - i)));
        }
    }
    return text;
}

TEST(Dataset, EightBitTruthWithTheScaleOfTheScenesNameAndAMask) {
    const TemporaryFolder folder;
    write_pair(folder, "cones/im2.png", "cones/im6.png");
    write_image(folder.file("cones/disp2.png"), (cv::Mat_<std::uint8_t>(2, 3) << 0, 4, 5, 255, 8, 0));
    write_image(folder.file("cones/mask_nonocc.png"), (cv::Mat_<std::uint8_t>(2, 3) << 255, 255, 128, 255, 0, 0));
    const auto scenes = find_scenes(folder.file(""));
    ASSERT_EQ(scenes.size(), 1U);
    EXPECT_EQ(scenes[0].name, "cones");
    EXPECT_EQ(scenes[0].scale, 4);
    const GroundTruth truth = read_ground_truth(scenes[0]);
    EXPECT_EQ(truth.width, 3);
    EXPECT_EQ(truth.height, 2);
    EXPECT_THAT(truth.disparity, ElementsAre(unknown, 1.0F, 1.25F, 63.75F, 2.0F, unknown));
    EXPECT_THAT(truth.classes, ElementsAre(TruthClass::none, TruthClass::visible, TruthClass::occluded,
                                           TruthClass::visible, TruthClass::occluded, TruthClass::none));
    EXPECT_TRUE(truth.knows_occlusion);
    EXPECT_EQ(read_ground_truth(scenes[0], 8).disparity[1], 0.5F);
}

TEST(Dataset, ScalesOfTheKnownScenes) {
    const TemporaryFolder folder;
    constexpr std::array names{"tsukuba",        "sawtooth",        "Teddy",           "Aloe",
                               "HalfSize/Art",   "fuller/Art",      "something",       "halftone/FullSize/Aloe",
                               "full-size/Aloe", "Cones-1",         "cones-1/cropped", "HalfSize/ThirdSize/Aloe",
                               "Art/HalfSize",   "map-of-town/mine"};
    for (const char* name : names) {
        write_pair(folder, std::string(name) + "/left.png", std::string(name) + "/right.png");
        write_image(folder.file(std::string(name) + "/disp_left.pgm"), numbered_image(3, 2, CV_8UC1, 1));
    }
    const auto scale = [&](const char* name) { return find_scenes(folder.file(name)).at(0).scale; };
    EXPECT_EQ(scale("tsukuba"), 16);
    EXPECT_EQ(scale("sawtooth"), 8);
    EXPECT_EQ(scale("Teddy"), 4);
    EXPECT_EQ(scale("Aloe"), 3);
    EXPECT_EQ(scale("HalfSize/Art"), 2);
    EXPECT_EQ(scale("fuller/Art"), 3);
    EXPECT_EQ(scale("halftone/FullSize/Aloe"), 1);
    EXPECT_EQ(scale("HalfSize/ThirdSize/Aloe"), 3);
    EXPECT_EQ(scale("Art/HalfSize"), 2);
    EXPECT_EQ(scale("full-size/Aloe"), 0) << "it may be the size";
    EXPECT_EQ(scale("Cones-1"), 4);
    EXPECT_EQ(scale("map-of-town/mine"), 0);
    EXPECT_EQ(scale("cones-1/cropped"), 0);
    EXPECT_EQ(scale("something"), 0);
    const DatasetScene unknown_scene = find_scenes(folder.file("something")).at(0);
    EXPECT_THAT(refusal([&] { read_ground_truth(unknown_scene); }), HasSubstr("give the scale"));
    EXPECT_NO_THROW(read_ground_truth(unknown_scene, 2));
    EXPECT_EQ(find_scenes(folder.file("")).size(), names.size());
}

TEST(Dataset, PfmFromTheBottomUpInBothByteOrdersWithBothLineEnds) {
    const TemporaryFolder folder;
    write_pair(folder, "left.png", "right.png");
    for (const bool little : {true, false}) {
        for (const std::string end : {"\n", "\r\n"}) {
            write_file(folder.file("disp_left.pfm"), "Pf" + end + "3 2" + end + (little ? "-0.5" : "1") + end +
                                                         pfm_bytes({4, 5, INFINITY, 1.5, 2, NAN}, little));
            const GroundTruth truth = read_ground_truth(find_scenes(folder.file("")).at(0));
            EXPECT_THAT(truth.disparity, ElementsAre(1.5F, 2.0F, unknown, 4.0F, 5.0F, unknown));
            EXPECT_EQ(truth.classes[2], TruthClass::none);
            EXPECT_EQ(truth.classes[3], TruthClass::visible);
            EXPECT_FALSE(truth.knows_occlusion);
        }
    }
}

TEST(Dataset, KittiFramesWithVisibleAndAllPixels) {
    const TemporaryFolder folder;
    for (const char* name : {"000000_10.png", "000000_11.png", "000001_10.png"}) {
        write_pair(folder, std::string("training/image_2/") + name, std::string("training/image_3/") + name);
    }
    std::filesystem::create_directories(folder.file("training/disp_occ_0"));
    std::filesystem::create_directories(folder.file("training/disp_noc_0"));
    for (const char* name : {"000000_10.png", "000001_10.png"}) {
        write_image(folder.file(std::string("training/disp_occ_0/") + name),
                    (cv::Mat_<std::uint16_t>(2, 3) << 256, 384, 0, 25600, 1, 0));
        write_image(folder.file(std::string("training/disp_noc_0/") + name),
                    (cv::Mat_<std::uint16_t>(2, 3) << 256, 0, 0, 25600, 0, 0));
    }
    const auto scenes = find_scenes(folder.file(""));
    ASSERT_EQ(scenes.size(), 2U);
    EXPECT_EQ(scenes[0].name, "training/000000_10");
    EXPECT_EQ(scenes[1].name, "training/000001_10");
    const GroundTruth truth = read_ground_truth(scenes[1]);
    EXPECT_THAT(truth.disparity, ElementsAre(1.0F, 1.5F, unknown, 100.0F, 1.0F / 256, unknown));
    EXPECT_THAT(truth.classes, ElementsAre(TruthClass::visible, TruthClass::occluded, TruthClass::none,
                                           TruthClass::visible, TruthClass::occluded, TruthClass::none));
}

TEST(DatasetRefuses, FilesThatDoNotBelongTogetherOrAreDamaged) {
    const TemporaryFolder folder;
    EXPECT_THAT(refusal([&] { find_scenes(folder.file("absent")); }), HasSubstr("no such folder"));
    EXPECT_TRUE(find_scenes(folder.file("")).empty());
    write_file(folder.file("a.png"), "");
    EXPECT_THAT(refusal([&] { find_scenes(folder.file("a.png")); }), HasSubstr("is a file, expected the folder"));
    write_pair(folder, "teddy/left.png", "teddy/right.png");
    write_image(folder.file("teddy/disp_left.png"), numbered_image(4, 2, CV_8UC1, 1));
    const DatasetScene scene = find_scenes(folder.file("")).at(0);
    EXPECT_THAT(refusal([&] { read_ground_truth(scene); }),
                AllOf(HasSubstr("left.png is 3x2"), HasSubstr("disp_left.png is 4x2")));
    write_image(folder.file("teddy/disp_left.png"), numbered_image(3, 2, CV_8UC3, 1));
    EXPECT_THAT(refusal([&] { read_ground_truth(scene); }), HasSubstr("no grey image"));
    write_file(folder.file("teddy/disp_left.pfm"), "Pf\n3 2\n-1\n" + pfm_bytes({1, 2, 3, 4, 5}, true));
    const DatasetScene cut = find_scenes(folder.file("")).at(0);
    EXPECT_THAT(refusal([&] { read_ground_truth(cut); }), HasSubstr("20 bytes of pixels where 24 are announced"));
    for (const char* head : {"Pf\n3 -2\n-1\n", "PF\n3 2\n-1\n", "Pf\n3 2\n0\n", "Pf\n99999999999 2\n-1\n", ""}) {
        write_file(folder.file("teddy/disp_left.pfm"), head);
        EXPECT_THAT(refusal([&] { read_ground_truth(cut); }), HasSubstr("a grey PFM picture")) << head;
    }
}

TEST(Dataset, TheEvaluationScenesAreAllFound) {
    const std::filesystem::path root = disparityd::test::data_folder();
    if (!std::filesystem::is_directory(root / "middlebury2003")) {
        GTEST_SKIP() << "no evaluation data at DISPARITYD_DATA or ../shared/data";
    }
    const auto scenes = find_scenes(root.string());
    EXPECT_GE(scenes.size(), 12U);
    for (const DatasetScene& scene : scenes) {
        const GroundTruth truth = read_ground_truth(scene);
        double largest = 0;
        std::size_t visible = 0;
        for (std::size_t i = 0; i < truth.disparity.size(); ++i) {
            if (truth.classes[i] != TruthClass::none) {
                largest = std::max(largest, static_cast<double>(truth.disparity[i]));
            }
            visible += truth.classes[i] == TruthClass::visible ? 1 : 0;
        }
        EXPECT_GT(largest, 10) << scene.name;
        EXPECT_LT(largest, 110) << scene.name;
        EXPECT_GT(visible, truth.disparity.size() / 2) << scene.name;
    }
}

}  // namespace
}  // namespace disparityd::datasets
