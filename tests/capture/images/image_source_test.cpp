// SPDX-License-Identifier: Apache-2.0
//
// Images as people have them: KITTI's calibration of each scene, two plain files, 16 bits, damaged ones.
#include <filesystem>

#include "capture/frame_source.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture {
namespace {

using test::numbered_image;
using test::refusal;
using test::soon;
using test::TemporaryFolder;
using test::write_file;
using test::write_image;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using Next = FrameSource::Next;

/// What a source says while it is opened and read.
struct Said {
    std::vector<std::string> notices;
    std::vector<std::string> troubles;
};

SourceOptions options_of(const std::string& uri, Said* said = nullptr) {
    SourceOptions options;
    options.uri = uri;
    options.pace = Pace::fastest;
    if (said != nullptr) {
        options.report = [said](const std::string& line, bool trouble) {
            (trouble ? said->troubles : said->notices).push_back(line);
        };
    }
    return options;
}

/// KITTI's layout of 2015 (or, grey, of 2012) with two times of each scene.
void make_kitti(const TemporaryFolder& folder, const char* left, const char* right, int scenes) {
    std::filesystem::create_directories(folder.file(left));
    std::filesystem::create_directories(folder.file(right));
    for (int i = 0; i < scenes; ++i) {
        for (const char* time : {"_10.png", "_11.png"}) {
            const std::string name = "/00000" + std::to_string(i) + time;
            write_image(folder.file(left + name), numbered_image(8, 4, CV_8UC1, i));
            write_image(folder.file(right + name), numbered_image(8, 4, CV_8UC1, 10 + i));
        }
    }
}

/// The lines that KITTI documents for calib_cam_to_cam, as far as they matter; shift is P_rect_03's fourth number.
std::string cam_to_cam(const std::string& shift) {
    return "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.950000e-02\nS_02: 1.392000e+03 5.120000e+02\n"
           "K_02: 9.597910e+02 0 6.960217e+02 0 9.569251e+02 2.241806e+02 0 0 1\n"
           "S_rect_02: 8.000000e+00 4.000000e+00\n"
           "P_rect_02: 1.250000e+01 0 3.5 1.0 0 1.250000e+01 2 0.5 0 0 1 0.003\n"
           "S_rect_03: 8.000000e+00 4.000000e+00\n"
           "P_rect_03: 1.250000e+01 0 3.5 " +
           shift + " 0 1.250000e+01 2 0.5 0 0 1 0.003\n";
}

TEST(KittiCalibration, Of2015LiesBesideEachScene) {
    const TemporaryFolder folder;
    make_kitti(folder, "image_2", "image_3", 2);
    std::filesystem::create_directories(folder.file("calib_cam_to_cam"));
    write_file(folder.file("calib_cam_to_cam/000000.txt"), cam_to_cam("-5.75"));
    write_file(folder.file("calib_cam_to_cam/000001.txt"), cam_to_cam("-5.75"));
    Said said;
    const auto source = open_source(options_of(folder.file(""), &said));
    ASSERT_TRUE(source->info().calibration);
    EXPECT_EQ(source->info().calibration->left.fx, 12.5);
    EXPECT_EQ(source->info().calibration->left.cx, 3.5);
    EXPECT_NEAR(source->info().calibration->translation[0], -540, 1e-9) << "(-5.75 - 1) / 12.5 m";
    EXPECT_THAT(source->info().calibration->origin, HasSubstr("calib_cam_to_cam/000000.txt"));
    EXPECT_THAT(said.notices, ElementsAre());
}

TEST(KittiCalibration, Of2012HasTheGreyCameras) {
    const TemporaryFolder folder;
    make_kitti(folder, "image_0", "image_1", 1);
    std::filesystem::create_directories(folder.file("calib"));
    write_file(folder.file("calib/000000.txt"),
               "P0: 12.5 0 3.5 0 0 12.5 2 0 0 0 1 0\nP1: 12.5 0 3.5 -6.75 0 12.5 2 0 0 0 1 0\n"
               "P2: 9 0 3 0.4 0 9 2 0 0 0 1 0\nP3: 9 0 3 -3.6 0 9 2 0 0 0 1 0\n");
    const auto source = open_source(options_of(folder.file("")));
    EXPECT_EQ(source->info().calibration->left.fx, 12.5);
    EXPECT_NEAR(source->info().calibration->translation[0], -540, 1e-9);
}

TEST(KittiCalibration, ScenesThatDifferHaveNoneInCommon) {
    const TemporaryFolder folder;
    make_kitti(folder, "image_2", "image_3", 2);
    std::filesystem::create_directories(folder.file("calib_cam_to_cam"));
    write_file(folder.file("calib_cam_to_cam/000000.txt"), cam_to_cam("-5.75"));
    write_file(folder.file("calib_cam_to_cam/000001.txt"), cam_to_cam("-5.5"));
    Said said;
    const auto source = open_source(options_of(folder.file(""), &said));
    EXPECT_EQ(source->info().calibration->left.fx, 0) << "rectified, distances unknown";
    EXPECT_THAT(said.notices, ElementsAre(AllOf(HasSubstr("000000.txt"), HasSubstr("000001.txt"),
                                                HasSubstr("distances are not known"))));
    SourceOptions named = options_of(folder.file(""));
    named.calibration_path = folder.file("calib_cam_to_cam/000001.txt");
    EXPECT_NEAR(open_source(named)->info().calibration->translation[0], -520, 1e-9);
}

TEST(KittiCalibration, OfAnotherSizeOrWithoutAFocalLengthIsRefused) {
    const TemporaryFolder folder;
    make_kitti(folder, "image_2", "image_3", 1);
    std::string text = cam_to_cam("-5.75");
    text.replace(text.find("8.000000e+00 4"), 14, "1.242000e+03 4");
    write_file(folder.file("calib_cam_to_cam.txt"), text);
    EXPECT_THAT(refusal([&] { open_source(options_of(folder.file(""))); }),
                AllOf(HasSubstr("calib_cam_to_cam.txt"), HasSubstr("1242x4"), HasSubstr("8x4")));
    write_file(folder.file("calib_cam_to_cam.txt"),
               "P_rect_02: 0 0 3 0 0 0 2 0 0 0 1 0\nP_rect_03: 0 0 3 0 0 0 2 0 0 0 1 0\n");
    EXPECT_THAT(refusal([&] { open_source(options_of(folder.file(""))); }),
                AllOf(HasSubstr("P_rect_02"), HasSubstr("focal length of 0")));
}

TEST(PlainPair, TwoNamesAreOneFrame) {
    const TemporaryFolder folder;
    const cv::Mat left = numbered_image(6, 4, CV_8UC1, 1);
    const cv::Mat right = numbered_image(6, 4, CV_8UC1, 2);
    write_image(folder.file("any, name.png"), left);
    write_image(folder.file("other.PNG"), right);
    const auto source = open_source(options_of(folder.file("any, name.png") + "," + folder.file("other.PNG")));
    EXPECT_EQ(source->info().frame_count, 1U);
    EXPECT_FALSE(source->info().calibration) << "nothing says that they are rectified";
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    EXPECT_EQ(frame.name, "any, name.png");
    EXPECT_TRUE(std::equal(left.data, left.data + 6, frame.image.eye(Eye::left).row(0)));
    EXPECT_TRUE(std::equal(right.data, right.data + 6, frame.image.eye(Eye::right).row(0)));
    source->give_back(frame);
    EXPECT_EQ(source->next(frame, soon()), Next::end);
}

TEST(PlainPair, OneNameOrAnAbsentOneSaysWhatToDo) {
    const TemporaryFolder folder;
    write_image(folder.file("a.png"), numbered_image(6, 4, CV_8UC1, 1));
    EXPECT_THAT(refusal([&] { open_source(options_of(folder.file("a.png"))); }),
                AllOf(HasSubstr("a.png: is one image"), HasSubstr("left.png,right.png")));
    EXPECT_THAT(refusal([&] { open_source(options_of(folder.file("a.png") + "," + folder.file("b.png"))); }),
                HasSubstr("b.png: no such file"));
    std::filesystem::create_symlink(folder.file("a.png"), folder.file("b.png"));
    EXPECT_THAT(refusal([&] { open_source(options_of(folder.file("a.png") + "," + folder.file("b.png"))); }),
                HasSubstr("a.png: is named for both eyes"));
}

TEST(DeepImages, KeepTheUpperEightOfTheirBits) {
    const TemporaryFolder folder;
    cv::Mat left(2, 4, CV_16UC1);
    cv::Mat right(2, 4, CV_16UC1);
    for (int i = 0; i < 8; ++i) {
        left.at<std::uint16_t>(i / 4, i % 4) = static_cast<std::uint16_t>(500 * i + 255);
        right.at<std::uint16_t>(i / 4, i % 4) = static_cast<std::uint16_t>(9000 * i);
    }
    write_image(folder.file("l0.png"), left);
    write_image(folder.file("r0.png"), right);
    const std::string uri = folder.file("l%d.png") + "," + folder.file("r%d.png");
    for (const auto& [suffix, bits] : {std::pair("", 16), {"?bits=16", 16}, {"?bits=12", 12}, {"?bits=9", 9}}) {
        Said said;
        const auto source = open_source(options_of(uri + suffix, &said));
        EXPECT_EQ(source->info().format, PixelFormat::grey8);
        RawFrame frame;
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        for (int i = 0; i < 8; ++i) {
            const auto expected = [bits = bits](int value) { return std::min(value >> (bits - 8), 255); };
            EXPECT_EQ(frame.image.eye(Eye::left).row(i / 4)[i % 4], expected(500 * i + 255)) << bits << ", " << i;
            EXPECT_EQ(frame.image.eye(Eye::right).row(i / 4)[i % 4], expected(9000 * i)) << bits << ", " << i;
        }
        source->give_back(frame);
        EXPECT_THAT(said.notices, ElementsAre(AllOf(HasSubstr("value / " + std::to_string(1 << (bits - 8)) + " "),
                                                    HasSubstr("first frame is 63000"))));
        EXPECT_EQ(said.notices.at(0).find("?bits=12") != std::string::npos, bits == 16) << "advice for who gave none";
    }
    for (const char* bits : {"8", "17", "12.5", "", "many"}) {
        EXPECT_THAT(refusal([&] { open_source(options_of(uri + "?bits=" + bits)); }),
                    AllOf(HasSubstr("bits"), HasSubstr("9 to 16")));
    }
}

TEST(DeepImages, OfFewerBitsByTheirHeader) {
    for (const auto& [largest, bits] : {std::pair(1023, 10), {4095, 12}, {4000, 12}, {300, 9}, {65535, 16}}) {
        for (const bool text : {false, true}) {
            const TemporaryFolder folder;
            std::string file = std::string(text ? "P2" : "P5") + "\n# made\n4 1\n" + std::to_string(largest) + "\n";
            for (const int value : {0, largest / 3, largest / 2, largest}) {
                file += text ? " " + std::to_string(value)
                             : std::string{static_cast<char>(value >> 8), static_cast<char>(value & 0xff)};
            }
            write_file(folder.file("a0.pgm"), file);
            Said said;
            const auto source = open_source(options_of(folder.file("a%d.pgm"), &said));
            EXPECT_THAT(said.notices, testing::Contains(HasSubstr("value / " + std::to_string(1 << (bits - 8)))));
            RawFrame frame;
            ASSERT_EQ(source->next(frame, soon()), Next::frame);
            EXPECT_EQ(frame.image.eye(Eye::right).row(0)[1], std::min(largest >> (bits - 8), 255));
            source->give_back(frame);
        }
    }
    // A PNG does not say how many it has.
    const TemporaryFolder folder;
    write_image(folder.file("a0.png"), cv::Mat(1, 2, CV_16UC1, cv::Scalar(700)));
    Said said;
    open_source(options_of(folder.file("a%d.png"), &said));
    EXPECT_THAT(said.notices, testing::Contains(AllOf(HasSubstr("little is left"), HasSubstr("?bits=10"))));
}

TEST(DeepImages, OfColourWithTransparencyAreRead) {
    const TemporaryFolder folder;
    write_image(folder.file("a0.png"), cv::Mat(2, 4, CV_16UC4, cv::Scalar(0x1234, 0x5678, 0x9abc, 0xffff)));
    const auto source = open_source(options_of(folder.file("a%d.png")));
    EXPECT_EQ(source->info().format, PixelFormat::bgr24);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    const std::uint8_t* pixel = frame.image.eye(Eye::left).row(0);
    EXPECT_THAT(std::vector<int>(pixel, pixel + 3), ElementsAre(0x12, 0x56, 0x9a));
    source->give_back(frame);
}

class DamagedImages : public testing::Test {
protected:
    DamagedImages() {
        for (int i = 0; i < 5; ++i) {
            write_image(name(i), numbered_image(8, 4, CV_8UC1, i));
        }
        for (const int i : {0, 2}) {
            std::filesystem::resize_file(name(i), 40);  // the header is whole
        }
        write_image(name(4), numbered_image(6, 4, CV_8UC1, 4));
    }
    std::string name(int i) const { return folder_.file("a" + std::to_string(i) + ".png"); }
    TemporaryFolder folder_;
};

TEST_F(DamagedImages, AreLeftOutOnRequest) {
    Said said;
    SourceOptions options = options_of(folder_.file("a%d.png"), &said);
    options.skip_damaged = true;
    const auto source = open_source(options);
    EXPECT_EQ(source->info().eye_width, 4);
    for (const int i : {1, 3}) {
        RawFrame frame;
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        EXPECT_EQ(frame.name, "a" + std::to_string(i) + ".png");
        EXPECT_EQ(frame.sequence, static_cast<std::uint64_t>(i));
        EXPECT_EQ(frame.dropped_before, 1U);
        EXPECT_EQ(frame.flags, frame_flag_discontinuity);
        EXPECT_EQ(frame.image.eye(Eye::left).row(0)[0], numbered_image(8, 4, CV_8UC1, i).data[0]);
        source->give_back(frame);
    }
    RawFrame none;
    EXPECT_EQ(source->next(none, soon()), Next::end);
    EXPECT_THAT(said.troubles, ElementsAre(AllOf(HasSubstr("a0.png"), HasSubstr("damaged")), HasSubstr("a2.png"),
                                           AllOf(HasSubstr("a4.png"), HasSubstr("unequal sizes"))));
}

TEST_F(DamagedImages, EndTheSourceOtherwise) {
    EXPECT_THAT(refusal([&] { open_source(options_of(folder_.file("a%d.png"))); }), HasSubstr("a0.png"));
    for (const int i : {0, 4}) {
        write_image(name(i), numbered_image(8, 4, CV_8UC1, i));
    }
    const auto source = open_source(options_of(folder_.file("a%d.png")));
    RawFrame frame;
    for (int i = 0; i < 2; ++i) {
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        source->give_back(frame);
    }
    EXPECT_THAT([&] { source->next(frame, soon()); }, testing::ThrowsMessage<std::runtime_error>(HasSubstr("a2.png")));
    EXPECT_EQ(source->next(frame, soon()), Next::end);
}

TEST_F(DamagedImages, AloneAreNoSource) {
    std::filesystem::remove(name(1));
    std::filesystem::remove(name(3));
    std::filesystem::remove(name(4));
    SourceOptions options = options_of(folder_.file("a%d.png"));
    options.skip_damaged = true;
    EXPECT_THAT(refusal([&] { open_source(options); }), HasSubstr("a2.png"));
}

}  // namespace
}  // namespace disparityd::capture
