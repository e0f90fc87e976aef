// SPDX-License-Identifier: Apache-2.0
//
// SVO2 files that somebody made from the public description who had not seen the reader.
#include <algorithm>
#include <filesystem>
#include <numbers>

#include "tests/capture/played_source.h"
#include "tests/formats/svo2_writer.h"
#include "tests/temporary_folder.h"

namespace disparityd::capture {
namespace {

using disparityd::test::Svo2File;
using disparityd::test::Svo2Payload;
using disparityd::test::TemporaryFolder;
using test::play_all;
using test::Played;
using testing::AllOf;
using testing::HasSubstr;

Played play(const Svo2File& file) {
    const TemporaryFolder folder;
    SourceOptions options;
    options.uri = folder.write("a.svo2", disparityd::test::svo2_bytes(file));
    return play_all(options);
}

std::vector<std::uint8_t> bgr_of(const disparityd::test::Svo2Picture& picture) {
    std::vector<std::uint8_t> pixels = disparityd::test::svo2_rgb(picture);
    for (std::size_t i = 0; i < pixels.size(); i += 3) {
        std::swap(pixels[i], pixels[i + 2]);
    }
    return pixels;
}

std::vector<std::uint8_t> yuyv_of(const disparityd::test::Svo2Picture& picture) {
    std::vector<std::uint8_t> pixels;
    const auto width = static_cast<std::size_t>(picture.width);
    for (std::size_t i = 0; i < picture.luma.size(); ++i) {
        pixels.push_back(picture.luma[i]);
        const std::size_t chroma = i / width / 2 * (width / 2) + i % width / 2;
        pixels.push_back((i % 2 == 0 ? picture.blue : picture.red)[chroma]);
    }
    return pixels;
}

std::vector<std::uint8_t> expected_pixels(const Svo2File& file, PixelFormat format, int number) {
    const auto picture = disparityd::test::svo2_picture(file.eye_width, file.height, file.disparity, number);
    return format == PixelFormat::bgr24  ? bgr_of(picture)
           : format == PixelFormat::yuyv ? yuyv_of(picture)
                                         : picture.luma;
}

TEST(MadeSvo, WithoutLossIsReadByteForByte) {
    for (const Svo2Payload payload :
         {Svo2Payload::h264_lossless, Svo2Payload::h264_lossless_444, Svo2Payload::h265_lossless, Svo2Payload::png,
          Svo2Payload::zstd_bgra, Svo2Payload::zstd_bgr, Svo2Payload::zstd_yuyv, Svo2Payload::zstd_grey}) {
        for (const bool one_eye : {false, true}) {
            Svo2File file;
            file.payload = payload;
            file.width_of_one_eye = one_eye;
            if (!can_write(payload)) {
                continue;  // this FFmpeg has no encoder
            }
            const Played played = play(file);
            EXPECT_EQ(played.problem, "");
            ASSERT_EQ(played.frames.size(), 12U);
            for (int i = 0; i < 12; ++i) {
                EXPECT_TRUE(played.frames[static_cast<std::size_t>(i)] == expected_pixels(file, played.info.format, i))
                    << "payload " << static_cast<int>(payload) << ", frame " << i;
            }
        }
    }
}

TEST(MadeSvo, GivesWhatTheSameImagesGiveAsAFolder) {
    for (const auto& [payload, type] : {std::pair(Svo2Payload::zstd_grey, CV_8UC1), {Svo2Payload::zstd_bgr, CV_8UC3}}) {
        Svo2File file;
        file.payload = payload;
        file.frames = 3;
        const TemporaryFolder folder;
        for (const int eye : {0, 1}) {
            const std::string images = folder.file(eye == 0 ? "left" : "right");
            std::filesystem::create_directories(images);
            for (int i = 0; i < file.frames; ++i) {
                auto pixels = expected_pixels(file, type == CV_8UC1 ? PixelFormat::grey8 : PixelFormat::bgr24, i);
                const cv::Mat both(file.height, 2 * file.eye_width, type, pixels.data());
                test::write_image(images + "/" + std::to_string(i) + ".png",
                                  both.colRange(eye * file.eye_width, (eye + 1) * file.eye_width));
            }
        }
        SourceOptions options;
        options.uri = folder.path();
        EXPECT_TRUE(play_all(options).frames == play(file).frames);
    }
}

TEST(MadeSvo, TimesNumbersAndSamplesAreThoseOfTheFile) {
    for (const std::uint64_t unit_ns : {1ULL, 1'000ULL, 1'000'000ULL}) {
        Svo2File file;
        file.payload = Svo2Payload::zstd_grey;
        file.lost = {3, 4, 8};
        file.stamp_unit_ns = unit_ns;
        const Played played = play(file);
        EXPECT_EQ(played.problem, "");
        const std::vector<int> numbers = svo2_frame_numbers(file);
        ASSERT_EQ(played.sequences.size(), numbers.size());
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            EXPECT_EQ(played.sequences[i], static_cast<std::uint64_t>(numbers[i]));
            EXPECT_EQ(played.times[i], static_cast<std::int64_t>(svo2_frame_ns(file, numbers[i])));
        }
        // What was measured behind the last frame belongs to none.
        ASSERT_EQ(played.samples.size(), 44U);
        for (int i = 0; i < 44; ++i) {
            const disparityd::test::Svo2Sample expected = svo2_sample(file, i);
            const SensorSample& found = played.samples[static_cast<std::size_t>(i)];
            EXPECT_EQ(found.realtime_ns, static_cast<std::int64_t>(expected.time_ns));
            EXPECT_FLOAT_EQ(found.angular_velocity.z, expected.degrees_per_s[2] * std::numbers::pi_v<float> / 180);
            EXPECT_FLOAT_EQ(found.acceleration.y, expected.metres_per_s2[1]);
        }
    }
}

TEST(MadeSvo, DamageInOneMessageCostsItsFrameAndThoseThatBuildOnIt) {
    constexpr int damaged = 6;
    using Change = std::function<void(std::string&)>;
    for (const Change& change :
         {Change([](std::string& m) { m.clear(); }), Change([](std::string& m) { m.resize(6); }),
          Change([](std::string& m) { m.resize(m.size() - 40); }), Change([](std::string& m) { m[7] = '\xFF'; }),
          Change([](std::string& m) { m.replace(4, 4, 4, '\0'); })}) {
        for (const Svo2Payload payload : {Svo2Payload::h264_lossless, Svo2Payload::png}) {
            Svo2File file;
            file.payload = payload;
            file.change = [&](std::string& message, int number) {
                if (number == damaged) {
                    change(message);
                }
            };
            if (!can_write(payload)) {
                continue;
            }
            const Played played = play(file);
            EXPECT_THAT(played.problem, AllOf(HasSubstr("of 12 video messages gave no frame, the first because")));
            const bool video = payload == Svo2Payload::h264_lossless;
            EXPECT_EQ(played.frames.size(), video ? 8U : 11U) << "the next key frame is 10";
            EXPECT_EQ(std::count(played.lost.begin(), played.lost.end(), video ? 4U : 1U), 1);
        }
    }
}

TEST(MadeSvo, StampsAndNumbersThatMakeNoSenseAreReplaced) {
    for (const char byte : {'\0', '\xFF'}) {
        Svo2File file;
        file.payload = Svo2Payload::zstd_grey;
        file.change = [&](std::string& message, int number) {
            if (number == 6) {
                message.replace(message.size() - 0x20, 8, 8, byte);
                message.replace(message.size() - 8, 4, 4, '\xFF');
            }
        };
        const Played played = play(file);
        EXPECT_EQ(played.problem, "");
        ASSERT_EQ(played.times.size(), 12U);
        EXPECT_NEAR(static_cast<double>(played.times[6] - played.times[5]), 1e9 / 30, 2);
        EXPECT_TRUE(std::is_sorted(played.times.begin(), played.times.end()));
        EXPECT_EQ(played.sequences, std::vector<std::uint64_t>({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
    }
}

TEST(MadeSvo, CutFilePlaysWhatIsWhole) {
    Svo2File file;
    file.payload = Svo2Payload::zstd_grey;
    file.mcap.chunks = false;
    const std::string bytes = svo2_bytes(file);
    const TemporaryFolder folder;
    SourceOptions options;
    options.uri = folder.write("a.svo2", bytes.substr(0, bytes.size() / 2));
    const Played played = play_all(options);
    EXPECT_GT(played.frames.size(), 2U);
    EXPECT_THAT(played.problem, HasSubstr("was cut off"));
}

TEST(MadeSvo, OtherVersionsAndEncryptedOnesAreRefused) {
    const TemporaryFolder folder;
    for (const char* name : {"a.svo", "a.svo2"}) {
        SourceOptions options;
        options.uri = folder.write(name, disparityd::test::svo1_bytes());
        EXPECT_THAT(play_all(options).problem, HasSubstr("SVO 1"));
    }
    Svo2File file;
    file.payload = Svo2Payload::encrypted;
    EXPECT_THAT(play(file).problem, AllOf(HasSubstr("begins with the bytes"), HasSubstr("encrypted")));
}

}  // namespace
}  // namespace disparityd::capture
