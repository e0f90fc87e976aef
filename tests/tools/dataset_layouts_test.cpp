// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "tests/capture/images/image_fixture.h"
#include "tests/temporary_folder.h"
#include "tools/datasets/dataset.h"
#include "tools/images/disparity_file.h"

namespace disparityd::datasets {
namespace {

using capture::test::numbered_image;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr float without_truth = std::numeric_limits<float>::infinity();
constexpr auto seen = TruthClass::visible;
constexpr auto hidden = TruthClass::occluded;

/// A folder that gets pictures of 3 x 1 pixels.
class Layouts : public testing::Test {
protected:
    std::string file(const std::string& name) const {
        const std::string path = folder_.file(name);
        std::filesystem::create_directories(std::filesystem::path(path).parent_path());
        return path;
    }
    void write_pair(const std::string& left, const std::string& right) const {
        capture::test::write_image(file(left), numbered_image(3, 1, CV_8UC1, 1));
        capture::test::write_image(file(right), numbered_image(3, 1, CV_8UC1, 2));
    }
    template <typename Pixel>
    void write(const std::string& name, const std::vector<Pixel>& pixels) const {
        capture::test::write_image(file(name), cv::Mat(pixels, true).reshape(0, 1));
    }
    void write_pfm(const std::string& name, const std::vector<float>& pixels) const {
        images::write_disparity_pfm(file(name), images::FloatMap{3, 1, pixels});
    }
    /// The names of what is found in a folder below.
    std::vector<std::string> names(const std::string& below = "") const {
        std::vector<std::string> found;
        for (const DatasetScene& scene : find_scenes(folder_.file(below))) {
            found.push_back(scene.name);
        }
        return found;
    }
    GroundTruth truth() const { return read_ground_truth(find_scenes(folder_.path()).at(0)); }

    test::TemporaryFolder folder_;
};

TEST_F(Layouts, SintelPacksDisparitiesIntoColours) {
    write_pair("training/final_left/alley_1/frame_0001.png", "training/final_right/alley_1/frame_0001.png");
    write_pair("training/clean_left/alley_1/frame_0001.png", "training/clean_right/alley_1/frame_0001.png");
    write<cv::Vec3b>("training/disparities/alley_1/frame_0001.png", {{0, 0, 0}, {64, 32, 2}, {0, 0, 255}});
    write<std::uint8_t>("training/occlusions/alley_1/frame_0001.png", {0, 255, 0});
    write<std::uint8_t>("training/outofframe/alley_1/frame_0001.png", {0, 0, 255});
    EXPECT_THAT(names(), ElementsAre("alley_1/frame_0001"));
    EXPECT_THAT(find_scenes(folder_.path())[0].left, HasSubstr("final_left"));
    EXPECT_THAT(find_scenes(folder_.file("training/clean_left")).at(0).left, HasSubstr("clean_left"));
    EXPECT_THAT(truth().disparity, ElementsAre(0, 8 + 0.5F + 64.0F / 16384, 1020));
    EXPECT_THAT(truth().classes, ElementsAre(seen, hidden, hidden));
}

TEST_F(Layouts, SceneFlowHasDisparitiesOfEitherSignOfBothEyes) {
    write_pair("frames_finalpass/TRAIN/A/0000/left/0006.png", "frames_finalpass/TRAIN/A/0000/right/0006.png");
    write_pfm("disparity/TRAIN/A/0000/left/0006.pfm", {-1, -1, -2});
    write_pfm("disparity/TRAIN/A/0000/right/0006.pfm", {3.5F, 7, 7});
    EXPECT_THAT(names(), ElementsAre("TRAIN/A/0000/0006"));
    EXPECT_THAT(truth().disparity, ElementsAre(1, 1, 2));
    EXPECT_THAT(truth().classes, ElementsAre(hidden, hidden, hidden)) << "outside, and behind what is nearer";
    write_pfm("disparity/TRAIN/A/0000/right/0006.pfm", {-2, 7, 7});
    EXPECT_THAT(truth().classes, ElementsAre(hidden, seen, seen)) << "at most 1 px nearer";
    write<std::uint8_t>("disparity_occlusions/TRAIN/A/0000/left/0006.png", {0, 255, 0});
    EXPECT_THAT(truth().classes, ElementsAre(seen, hidden, seen));
}

TEST_F(Layouts, LinksToFoldersAreToldAndNotFollowed) {
    write_pair("set/final_left/alley_1/frame_0001.png", "set/final_right/alley_1/frame_0001.png");
    write<cv::Vec3b>("set/disparities/alley_1/frame_0001.png", {{0, 0, 0}, {64, 32, 2}, {0, 0, 255}});
    for (const char* link : {"again", "set/final_left/a", "set/final_left/b", "set/final_left/alley_1/nowhere"}) {
        std::filesystem::create_symlink(std::string(link).ends_with("nowhere") ? "absent" : ".", file(link));
    }
    EXPECT_THAT(names(), ElementsAre("alley_1/frame_0001"));
    const std::string why = ": is a link to a folder, and is not followed";
    EXPECT_THAT(look_for_scenes(folder_.path()).incomplete,
                ElementsAre(HasSubstr("/again" + why), HasSubstr("/a" + why), HasSubstr("/b" + why)));
}

TEST_F(Layouts, AFolderThatCannotBeListedIsTold) {
    // Its path is too long for the system, which also stops the administrator.
    const std::string name(250, 'n');
    write_pair("lab_1/im0.png", "lab_1/im1.png");
    write_pfm("lab_1/disp0GT.pfm", {1, 1, 2});
    std::filesystem::create_directory(folder_.file(name));
    std::string root = folder_.path();
    while (root.size() < 3900) {
        root += "/.";
    }
    const FoundScenes found = look_for_scenes(root);
    EXPECT_EQ(found.scenes.size(), 1U);
    EXPECT_THAT(found.incomplete, ElementsAre(HasSubstr(": cannot be listed: ")));
}

TEST_F(Layouts, DrivingStereoHasTwoSizes) {
    write_pair("foggy/left-image-half-size/a.jpg", "foggy/right-image-half-size/a.jpg");
    write<std::uint16_t>("foggy/disparity-map-half-size/a.png", {256, 0, 384});
    write_pair("foggy/left-image-full-size/a.jpg", "foggy/right-image-full-size/a.jpg");
    write<std::uint16_t>("foggy/disparity-map-full-size/a.png", {256, 0, 384});
    EXPECT_THAT(names("foggy"), ElementsAre("foggy/full-size/a", "foggy/half-size/a"));
    const auto scenes = find_scenes(folder_.path());
    EXPECT_THAT(read_ground_truth(scenes.at(0)).disparity, ElementsAre(2, without_truth, 3));
    EXPECT_THAT(read_ground_truth(scenes.at(1)).disparity, ElementsAre(1, without_truth, 1.5F));
    EXPECT_FALSE(read_ground_truth(scenes.at(1)).knows_occlusion);
}

TEST_F(Layouts, Eth3dsTruthLiesApart) {
    write_pair("two_view_training/lab_1/im0.png", "two_view_training/lab_1/im1.png");
    write_pair("two_view_training/lab_2/im0.png", "two_view_training/lab_2/im1.png");
    write_pfm("two_view_training_gt/lab_1/disp0GT.pfm", {1, without_truth, 2});
    write<std::uint8_t>("two_view_training_gt/lab_1/mask0nocc.png", {255, 0, 128});
    const FoundScenes found = look_for_scenes(folder_.path());
    ASSERT_EQ(found.scenes.size(), 1U);
    EXPECT_EQ(found.scenes[0].name, "lab_1");
    EXPECT_THAT(truth().classes, ElementsAre(seen, TruthClass::none, hidden));
    EXPECT_THAT(found.incomplete, ElementsAre(HasSubstr("lab_2: has im0 and im1 and no ground truth")));
}

TEST_F(Layouts, KittiTellsWhatIsACarAndWhatIsIncomplete) {
    for (int frame = 0; frame < 25; ++frame) {
        const std::string name = std::to_string(100 + frame) + "_10.png";
        write_pair("training/image_2/" + name, "training/image_3/" + name);
    }
    write_pair("training/image_2/100_11.png", "training/image_3/100_11.png");
    write<std::uint16_t>("training/disp_occ_0/100_10.png", {256, 256, 0});
    write<std::uint8_t>("training/obj_map/100_10.png", {0, 3, 1});
    const FoundScenes found = look_for_scenes(folder_.path());
    EXPECT_THAT(names(), ElementsAre("training/100_10"));
    EXPECT_THAT(truth().foreground, ElementsAre(0, 1, 1));
    ASSERT_EQ(found.incomplete.size(), 21U) << "24 frames, and none of the second frame, which never has truth";
    EXPECT_THAT(found.incomplete[0], HasSubstr("101_10.png: has no ground truth"));
    EXPECT_EQ(found.incomplete[20], "and 4 pairs more like these");
    write_pair("testing/image_2/1_10.png", "testing/image_3/1_10.png");
    EXPECT_THAT(look_for_scenes(folder_.file("testing")).incomplete,
                ElementsAre(HasSubstr("testing: has image_2/image_3 and no ground truth")));
}

}  // namespace
}  // namespace disparityd::datasets
