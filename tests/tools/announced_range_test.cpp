// SPDX-License-Identifier: Apache-2.0
#include "tools/datasets/announced_range.h"

#include <filesystem>

#include <gmock/gmock.h>

#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::datasets {
namespace {

using capture::test::numbered_image;
using capture::test::refusal;
using capture::test::TemporaryFolder;
using capture::test::write_file;
using capture::test::write_image;
using testing::HasSubstr;

constexpr const char* calibration_text = "cam0=[9 0 1; 0 9 1; 0 0 1]\ncam1=[9 0 1; 0 9 1; 0 0 1]\nwidth=3\nheight=2\n";

void write_scene(const TemporaryFolder& folder, const std::string& calibration) {
    write_image(folder.file("im0.png"), numbered_image(3, 2, CV_8UC1, 1));
    write_image(folder.file("im1.png"), numbered_image(3, 2, CV_8UC1, 2));
    if (!calibration.empty()) {
        write_file(folder.file("calib.txt"), calibration);
    }
}

TEST(AnnouncedRange, IsNdispOfTheCalibration) {
    for (const char* line : {"ndisp=128\n", "ndisp = 128\r\n", "isint=0\nndisp=128"}) {
        const TemporaryFolder folder;
        write_scene(folder, std::string(calibration_text) + line);
        for (const std::string& source :
             {folder.file(""), folder.file("im0.png") + ',' + folder.file("im1.png"), folder.file("") + "?bits=12"}) {
            const auto announced = range_of_images(source);
            ASSERT_TRUE(announced) << source << ' ' << line;
            EXPECT_EQ(announced->largest, 127);
            EXPECT_THAT(announced->origin, HasSubstr("calib.txt says ndisp=128"));
        }
    }
}

TEST(AnnouncedRange, IsThatOfTheGroundTruthWhereThatReachesFarther) {
    const TemporaryFolder folder;
    write_scene(folder, std::string(calibration_text) + "ndisp=16\n");
    // ETH3D's name of the truth; bottom row first, and an unknown pixel.
    std::string truth = "Pf\n3 2\n-1\n";
    for (const float value : {1.0F, 2.0F, std::numeric_limits<float>::infinity(), 3.0F, 40.25F, 5.0F}) {
        truth.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    write_file(folder.file("disp0GT.pfm"), truth);
    const auto announced = range_of_images(folder.file(""));
    ASSERT_TRUE(announced);
    EXPECT_EQ(announced->largest, 40.25);
    EXPECT_THAT(announced->origin, HasSubstr("reaches 41 px"));
    // Of a pair of files only the calibration beside it counts.
    EXPECT_EQ(range_of_images(folder.file("im0.png") + ',' + folder.file("im1.png"))->largest, 15);
}

TEST(AnnouncedRange, OfKittiIsThatOfTheWholeTruth) {
    const TemporaryFolder folder;
    for (const char* name : {"image_2", "image_3", "disp_occ_0"}) {
        std::filesystem::create_directories(folder.file(name));
    }
    for (const auto& [name, disparity] : {std::pair("000000_10.png", 20), std::pair("000001_10.png", 90)}) {
        write_image(folder.file(std::string("image_2/") + name), numbered_image(3, 2, CV_8UC1, 1));
        write_image(folder.file(std::string("image_3/") + name), numbered_image(3, 2, CV_8UC1, 2));
        write_image(folder.file(std::string("disp_occ_0/") + name),
                    cv::Mat(2, 3, CV_16UC1, cv::Scalar(256 * disparity)));
    }
    const auto announced = range_of_images(folder.file(""));
    ASSERT_TRUE(announced);
    EXPECT_EQ(announced->largest, 90);
}

TEST(AnnouncedRange, IsNotKnownWhereNoFileTells) {
    const TemporaryFolder folder;
    write_scene(folder, calibration_text);
    EXPECT_FALSE(range_of_images(folder.file("")));
    EXPECT_FALSE(range_of_images("scene:vga"));
    EXPECT_FALSE(range_of_images(folder.file("walk.mkv")));
    EXPECT_FALSE(range_of_calibration(folder.file("absent.txt")));
    for (const char* line : {"ndisp=many\n", "ndisp=0\n", "ndisp=\n", "ndisp=70000\n"}) {
        write_file(folder.file("calib.txt"), line);
        EXPECT_THAT(refusal([&] { range_of_calibration(folder.file("calib.txt")); }),
                    HasSubstr("calib.txt: ndisp: found '"));
    }
}

TEST(AnnouncedRange, IsVmaxWhereThatIsLarger) {
    const TemporaryFolder folder;
    for (const auto& [lines, largest] :
         {std::pair("vmin=7\nvmax=131.5\n", 131.5), {"ndisp=64\nvmax=120\n", 120}, {"vmax=55\nndisp=65\n", 64}}) {
        write_file(folder.file("calib.txt"), lines);
        EXPECT_EQ(range_of_calibration(folder.file("calib.txt"))->largest, largest) << lines;
    }
}

}  // namespace
}  // namespace disparityd::datasets
