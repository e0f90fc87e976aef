// SPDX-License-Identifier: Apache-2.0
//
// ROS 2 bags as a source: the frames of every encoding, topics, files that are whole, cut off or damaged.
#include <filesystem>
#include <random>
#include <stdexcept>

#include <opencv2/imgproc.hpp>

#include "capture/bag/bag_reader.h"
#include "capture/frame_source.h"
#include "tests/capture/bag/bag_fixture.h"
#include "tests/capture/bag/played_bag.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/temporary_folder.h"

namespace disparityd::capture {
namespace {

using disparityd::test::bag_start_ns;
using disparityd::test::BagWriter;
using disparityd::test::TemporaryFolder;
using test::height;
using test::numbered_image;
using test::options_of;
using test::period;
using test::play_all;
using test::Played;
using test::refusal;
using test::soon;
using test::width;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Next = FrameSource::Next;

const std::string left = "/stereo/left/image_raw";
const std::string right = "/stereo/right/image_raw";

std::string grey_bag(int frames, disparityd::test::McapFeatures features = {}) {
    BagWriter bag(std::move(features));
    for (int i = 0; i < frames; ++i) {
        bag.image(left, bag_start_ns + i * period, numbered_image(width, height, CV_8UC1, i), "mono8", 5);
        bag.image(right, bag_start_ns + i * period, numbered_image(width, height, CV_8UC1, 100 + i), "mono8");
    }
    return bag.close();
}

TEST(BagSource, GivesWhatTheSameImagesGiveAsAFolder) {
    const TemporaryFolder folder;
    for (const int type : {CV_8UC1, CV_8UC3}) {
        BagWriter bag;
        for (const char* eye : {"left", "right"}) {
            std::filesystem::create_directories(folder.file(std::string("images/") + eye));
        }
        for (int i = 0; i < 3; ++i) {
            const std::int64_t stamp = bag_start_ns + i * period;
            for (const bool is_left : {true, false}) {
                const cv::Mat image = numbered_image(width, height, type, i + (is_left ? 0 : 100));
                test::write_image(folder.file(std::string("images/") + (is_left ? "left/" : "right/") +
                                              std::to_string(stamp) + ".png"),
                                  image);
                bag.image(is_left ? left : right, stamp, image, type == CV_8UC1 ? "mono8" : "bgr8");
            }
        }
        const Played images = play_all(options_of(folder.file("images")));
        const Played found = play_all(options_of(folder.write("a.mcap", bag.close())));
        EXPECT_EQ(found.problem, "");
        ASSERT_EQ(found.frames.size(), 3U);
        EXPECT_EQ(found.frames, images.frames);
        EXPECT_EQ(found.times, images.times);
        EXPECT_EQ(found.sequences, images.sequences);
    }
}

/// The frame that one pair of this encoding gives.
struct OneFrame {
    PixelFormat format;
    cv::Mat both;
};

OneFrame frame_of(const std::function<void(BagWriter&, const std::string& topic)>& add,
                  const std::string& parameters = "") {
    const TemporaryFolder folder;
    BagWriter bag;
    add(bag, left);
    add(bag, right);
    const auto source = open_source(options_of(folder.write("a.mcap", bag.close()) + parameters));
    RawFrame frame;
    EXPECT_EQ(source->next(frame, soon()), Next::frame);
    const int bytes = bytes_per_pixel(frame.image.format);
    const cv::Mat both(frame.image.height, 2 * frame.image.eye_width, CV_8UC(bytes),
                       const_cast<std::uint8_t*>(frame.image.data), static_cast<std::size_t>(frame.image.stride));
    OneFrame found{frame.image.format, both.clone()};
    source->give_back(frame);
    return found;
}

void expect_eyes(const OneFrame& found, PixelFormat format, const cv::Mat& eye) {
    EXPECT_EQ(found.format, format);
    cv::Mat both;
    cv::hconcat(eye, eye, both);
    ASSERT_EQ(found.both.type(), both.type());
    EXPECT_EQ(cv::norm(found.both, both, cv::NORM_INF), 0);
}

TEST(BagSource, TakesEveryEncoding) {
    const cv::Mat grey = numbered_image(width, height, CV_8UC1, 1);
    const cv::Mat bgr = numbered_image(width, height, CV_8UC3, 2);
    const auto raw = [](const cv::Mat& pixels, const std::string& encoding, const std::string& parameters = "") {
        return frame_of(
            [&](BagWriter& bag, const std::string& topic) { bag.image(topic, bag_start_ns, pixels, encoding, 2); },
            parameters);
    };
    const auto converted = [](const cv::Mat& pixels, int code) {
        cv::Mat result;
        cv::cvtColor(pixels, result, code);
        return result;
    };
    expect_eyes(raw(grey, "mono8"), PixelFormat::grey8, grey);
    expect_eyes(raw(bgr, "bgr8"), PixelFormat::bgr24, bgr);
    expect_eyes(raw(converted(bgr, cv::COLOR_BGR2RGB), "rgb8"), PixelFormat::bgr24, bgr);
    expect_eyes(raw(converted(bgr, cv::COLOR_BGR2BGRA), "bgra8"), PixelFormat::bgr24, bgr);
    expect_eyes(raw(converted(bgr, cv::COLOR_BGR2RGBA), "rgba8"), PixelFormat::bgr24, bgr);

    const cv::Mat yuyv = numbered_image(width, height, CV_8UC2, 3);
    cv::Mat uyvy(yuyv.size(), CV_8UC2);
    for (int i = 0; i < width * height; ++i) {
        uyvy.data[2 * i] = yuyv.data[2 * i + 1];
        uyvy.data[2 * i + 1] = yuyv.data[2 * i];
    }
    expect_eyes(raw(yuyv, "yuv422_yuy2"), PixelFormat::yuyv, yuyv);
    expect_eyes(raw(uyvy, "yuv422"), PixelFormat::yuyv, yuyv);

    cv::Mat deep;
    grey.convertTo(deep, CV_16U, 16, 7);  // 12 bits
    expect_eyes(raw(deep, "mono16", "?bits=12"), PixelFormat::grey8, grey);
}

TEST(BagSource, BayerPatternsAreNamedByTheirFirstRow) {
    // A surface of one colour has it in every pixel, whatever interpolates.
    const cv::Vec3b colour(10, 120, 240);
    const cv::Mat bgr(height, width, CV_8UC3, cv::Scalar(10, 120, 240));
    for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
        cv::Mat mosaic(height, width, CV_8UC1);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const char letter = pattern[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
                mosaic.at<std::uint8_t>(y, x) = colour[letter == 'b' ? 0 : letter == 'g' ? 1 : 2];
            }
        }
        expect_eyes(frame_of([&](BagWriter& bag, const std::string& topic) {
                        bag.image(topic, bag_start_ns, mosaic, "bayer_" + pattern + "8");
                    }),
                    PixelFormat::bgr24, bgr);
    }
}

TEST(BagSource, TakesCompressedImages) {
    const cv::Mat bgr = numbered_image(width, height, CV_8UC3, 2);
    std::vector<std::uint8_t> png, jpeg;
    ASSERT_TRUE(cv::imencode(".png", bgr, png));
    ASSERT_TRUE(cv::imencode(".jpg", bgr, jpeg));
    const auto one = [](const std::vector<std::uint8_t>& file) {
        return frame_of([&](BagWriter& bag, const std::string& topic) {
            bag.compressed(topic + "/compressed", bag_start_ns, "any",
                           {reinterpret_cast<const char*>(file.data()), file.size()});
        });
    };
    expect_eyes(one(png), PixelFormat::bgr24, bgr);
    const OneFrame lossy = one(jpeg);
    EXPECT_EQ(lossy.format, PixelFormat::bgr24);
    EXPECT_LT(cv::norm(lossy.both.colRange(0, width), bgr, cv::NORM_L2) / width, 30);
}

TEST(BagSource, RefusesImagesThatItCannotRead) {
    const TemporaryFolder folder;
    const auto problem = [&](const cv::Mat& pixels, const std::string& encoding) {
        BagWriter bag;
        bag.image(left, bag_start_ns, pixels, encoding);
        bag.image(right, bag_start_ns, pixels, encoding);
        return play_all(options_of(folder.write("a.mcap", bag.close()))).problem;
    };
    EXPECT_THAT(problem(cv::Mat(height, width, CV_32FC1), "32FC1"),
                AllOf(HasSubstr("a.mcap: /stereo/left/image_raw: "), HasSubstr("'32FC1', allowed are mono8")));
    EXPECT_THAT(problem(cv::Mat(height, width, CV_8UC1), "rgb8"),
                HasSubstr("3072 bytes and rows of 64, expected 9216"));
    BagWriter bag;
    bag.compressed(left, bag_start_ns, "h264", "abc");
    bag.compressed(right, bag_start_ns, "h264", "abc");
    EXPECT_THAT(play_all(options_of(folder.write("a.mcap", bag.close()))).problem,
                HasSubstr("of the format 'h264' that are neither JPEG nor PNG"));
}

TEST(BagSource, PairsTheNearestStampsAndCountsWhatIsAlone) {
    const TemporaryFolder folder;
    const cv::Mat image = numbered_image(width, height, CV_8UC1, 1);
    BagWriter bag;
    for (int i = 0; i < 10; ++i) {
        if (i != 3) {
            bag.image(left, bag_start_ns + i * period, image, "mono8");
        }
        if (i != 6 && i != 7) {
            bag.image(right, bag_start_ns + i * period + 2'000'000, image, "mono8");
        }
    }
    const std::string path = folder.write("a.mcap", bag.close());
    const Played near = play_all(options_of(path));
    EXPECT_EQ(near.problem, "");
    EXPECT_THAT(near.sequences, ElementsAre(0, 1, 2, 4, 5, 8, 9));
    EXPECT_THAT(near.lost, ElementsAre(0, 0, 0, 1, 0, 2, 0));
    EXPECT_THAT(refusal([&] { open_source(options_of(path + "?within_ms=1")); }),
                HasSubstr("are at most 1 ms apart; name the topics of one camera, or another limit"));
}

TEST(BagSource, FindsTheOnePairOfTopicsOrListsSeveral) {
    const TemporaryFolder folder;
    const cv::Mat image = numbered_image(width, height, CV_8UC1, 1);
    const auto bag_of = [&](const std::vector<std::string>& topics) {
        BagWriter bag;
        for (const std::string& topic : topics) {
            bag.image(topic, bag_start_ns, image, "mono8");
        }
        return folder.write("a.mcap", bag.close());
    };
    const auto description = [](const std::string& uri) { return open_source(options_of(uri))->info().description; };
    EXPECT_THAT(description(bag_of({"/rear", "/camera/infra1/image_rect_raw", "/camera/infra2/image_rect_raw"})),
                HasSubstr("ROS bag, /camera/infra1/image_rect_raw and /camera/infra2/image_rect_raw, 64 x 48"));
    EXPECT_THAT(description(bag_of({"/cam0/image_raw", "/cam1/image_raw"})), HasSubstr("/cam0/image_raw and /cam1"));
    const std::string several = bag_of({left, right, "/left", "/right"});
    EXPECT_THAT(refusal([&] { description(several); }),
                AllOf(HasSubstr("images of several pairs; name one behind the source: ?left=/left&right=/right, "),
                      HasSubstr("?left=/stereo/left/image_raw&right=/stereo/right/image_raw")));
    EXPECT_THAT(description(several + "?left=/left&right=/right"), HasSubstr("/left and /right"));
    EXPECT_THAT(refusal([&] { description(several + "?left=/left&right=/rihgt"); }),
                AllOf(HasSubstr("no images of the topic /rihgt"), HasSubstr("/right, /stereo/left/image_raw")));
    EXPECT_THAT(refusal([&] { description(several + "?left=/left&right=/left"); }), HasSubstr("named for both eyes"));
    EXPECT_THAT(refusal([&] { description(several + "?left=/left"); }), HasSubstr("name both topics"));
    EXPECT_THAT(refusal([&] { description(several + "?lift=/left"); }),
                AllOf(HasSubstr("found 'lift=/left'"), HasSubstr("left=/TOPIC, right=/TOPIC")));
    EXPECT_THAT(refusal([&] { description(bag_of({"/a", "/b"})); }), HasSubstr("it has images of /a, /b"));
    EXPECT_THAT(refusal([&] { description(bag_of({})); }), HasSubstr("it has images of none"));
}

TEST(BagSource, OfSeveralPairsThatWithCalibrationsIsTaken) {
    const TemporaryFolder folder;
    BagWriter bag;
    for (const std::string pair : {"/debug", "/front", "/rear"}) {
        for (const std::string eye : {"/left", "/right"}) {
            bag.image(pair + eye + "/image_raw", bag_start_ns, numbered_image(width, height, CV_8UC1, 1), "mono8");
        }
    }
    bag.camera_info("/front/left/camera_info", bag_start_ns, {});
    bag.camera_info("/front/right/camera_info", bag_start_ns, disparityd::test::CameraInfoFields().right_of(0.12));
    bag.camera_info("/rear/left/camera_info", bag_start_ns, {});
    EXPECT_THAT(open_source(options_of(folder.write("a.mcap", bag.close())))->info().description,
                HasSubstr("ROS bag, /front/left/image_raw and /front/right/image_raw"));
}

TEST(BagSource, FurtherRoundsSearchNothing) {
    const TemporaryFolder folder;
    const std::string path = folder.write("a.mcap", grey_bag(3));
    const BagUri uri = parse_bag_uri(path);
    const ChosenTopics topics = BagReader(uri, true).topics();
    BagWriter bag;  // whose topics are not chosen without help
    for (const std::string& topic : {left, right, std::string("/left"), std::string("/right")}) {
        bag.image(topic, bag_start_ns, numbered_image(width, height, CV_8UC1, 1), "mono8");
    }
    folder.write("a.mcap", bag.close());
    EXPECT_THAT(refusal([&] { BagReader(uri, true); }), HasSubstr("images of several pairs"));
    EXPECT_EQ(BagReader(uri, false, topics).info().eye_width, width);
    // The rounds of a source are alike.
    folder.write("a.mcap", grey_bag(3));
    SourceOptions options = options_of(path);
    options.loop = true;
    const auto source = open_source(options);
    std::vector<std::uint8_t> first_bytes;
    for (std::uint64_t i = 0; i < 9; ++i) {
        RawFrame frame;
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        EXPECT_EQ(frame.sequence, i);
        first_bytes.push_back(*frame.image.data);
        source->give_back(frame);
    }
    EXPECT_THAT(first_bytes, testing::ElementsAreArray({first_bytes[0], first_bytes[1], first_bytes[2], first_bytes[0],
                                                        first_bytes[1], first_bytes[2], first_bytes[0], first_bytes[1],
                                                        first_bytes[2]}));
}

TEST(BagSource, MessagesAreReadByTheirOwnDefinitionAlsoWhereTypesShareAName) {
    const TemporaryFolder folder;
    disparityd::test::McapWriter writer;
    const std::array schemas{writer.schema("test/msg/A", "ros2msg", "uint8 value\nuint8 other\n"),
                             writer.schema("test/msg/A", "ros2msg", "uint8 other\nuint8 value\n")};
    for (int i = 0; i < 3000; ++i) {
        // Two writers on each topic, as several nodes have.
        const std::uint16_t channel =
            writer.channel(schemas[static_cast<std::size_t>(i) % 2], "/many/" + std::to_string(i / 2));
        writer.message(channel, 0, 1, {"\0\1\0\0\7\5", 6});
    }
    BagMessages bag(folder.write("a.mcap", writer.close()));
    const auto topics = bag.topics();
    ASSERT_EQ(topics.size(), 1500U);
    EXPECT_EQ(topics[7].messages, 2U);
    BagMessages::Message message;
    int read = 0;
    for (; bag.next(message); ++read) {
        ASSERT_EQ(bag.decode(message).number("value"), read % 2 == 0 ? 7 : 5);
    }
    EXPECT_EQ(read, 3000);
}

TEST(BagSource, OneTopicHasBothEyesSideBySide) {
    const TemporaryFolder folder;
    const cv::Mat both = numbered_image(2 * width, height, CV_8UC1, 1);
    BagWriter bag;
    bag.image("/zed/side_by_side", bag_start_ns, both, "mono8");
    bag.image("/zed/side_by_side", bag_start_ns + period, both, "mono8");
    const Played found = play_all(options_of(folder.write("a.mcap", bag.close())));
    ASSERT_EQ(found.frames.size(), 2U);
    EXPECT_TRUE(std::equal(found.frames[0].begin(), found.frames[0].end(), both.data));
    BagWriter one_eye;
    one_eye.image("/camera", bag_start_ns, numbered_image(width, height, CV_8UC1, 1), "mono8");
    EXPECT_THAT(refusal([&] { open_source(options_of(folder.write("b.mcap", one_eye.close()))); }),
                HasSubstr("found images of 64x48 on the one topic with images, which do not hold both eyes"));
}

TEST(BagSource, SamplesOfTheInertialSensorTravelWithTheFrames) {
    const TemporaryFolder folder;
    const cv::Mat image = numbered_image(width, height, CV_8UC1, 1);
    BagWriter bag;
    for (int i = 0; i < 3; ++i) {
        bag.imu("/imu", bag_start_ns + i * period - 1'000'000, 0.5 * i, 9.5);
        bag.image(left, bag_start_ns + i * period, image, "mono8");
        bag.image(right, bag_start_ns + i * period, image, "mono8");
    }
    const Played found = play_all(options_of(folder.write("a.mcap", bag.close())));
    ASSERT_EQ(found.samples.size(), 3U);
    EXPECT_EQ(found.samples[2].flags, sensor_flag_inertial);
    EXPECT_EQ(found.samples[2].angular_velocity, (SensorVector{1, 2, 3}));
    EXPECT_EQ(found.samples[2].acceleration, (SensorVector{9.5F, 19, 28.5F}));
    EXPECT_EQ(found.samples[2].realtime_ns, bag_start_ns + 2 * period - 1'000'000);
    EXPECT_EQ(found.samples[2].monotonic_ns, 2 * period - 1'000'000);
}

TEST(BagSource, IsReadWithoutASummaryToo) {
    const TemporaryFolder folder;
    disparityd::test::McapFeatures features;
    features.statistics = features.repeated_schemas = features.repeated_channels = features.chunk_index = false;
    const Played found = play_all(options_of(folder.write("a.mcap", grey_bag(4, features))));
    EXPECT_EQ(found.frames, play_all(options_of(folder.write("b.mcap", grey_bag(4)))).frames);
    EXPECT_EQ(found.frames.size(), 4U);
}

TEST(BagSource, AFolderIsItsFilesOneAfterTheOther) {
    const TemporaryFolder folder;
    std::string ending;
    const auto metadata = [&](const std::string& storage, const std::string& packing) {
        folder.write("metadata.yaml", "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: " + storage +
                                          "\n  relative_file_paths:\n    - a_0.mcap" + ending + "\n    - a_1.mcap" +
                                          ending +
                                          "\n"
                                          "  compression_format: \"" +
                                          packing + "\"\n");
    };
    folder.write("a_0.mcap", grey_bag(2));
    folder.write("a_1.mcap", grey_bag(3));
    metadata("mcap", "");
    const Played found = play_all(options_of(folder.path()));
    EXPECT_EQ(found.problem, "");
    EXPECT_EQ(found.frames.size(), 5U);
    metadata("tape", "");
    EXPECT_THAT(refusal([&] { open_source(options_of(folder.path())); }),
                HasSubstr("metadata.yaml: found a bag stored as 'tape', allowed are mcap and sqlite3"));
    metadata("mcap", "lzma");
    EXPECT_THAT(refusal([&] { open_source(options_of(folder.path())); }), HasSubstr("a bag packed by 'lzma'"));
    ending = ".zstd";
    metadata("mcap", "zstd\"\n  compression_mode: \"FILE");
    EXPECT_EQ(play_all(options_of(folder.path())).frames.size(), 5U) << "its files lie there unpacked";
    std::filesystem::rename(folder.file("a_1.mcap"), folder.file("a_1.mcap.zstd"));
    EXPECT_THAT(
        refusal([&] { open_source(options_of(folder.path())); }),
        AllOf(HasSubstr("a_1.mcap.zstd: is packed as a whole"),
              HasSubstr("zstd -d '" + folder.file("a_1.mcap.zstd") + "' -o '" + folder.file("a_1.mcap") + "'")));
    folder.write("metadata.yaml", "rosbag2_bagfile_information: [");
    EXPECT_THAT(refusal([&] { open_source(options_of(folder.path())); }), HasSubstr("is no YAML file: line"));
    folder.write("metadata.yaml", "rosbag2_bagfile_information: 1");
    EXPECT_THAT(refusal([&] { open_source(options_of(folder.path())); }), HasSubstr("this is no ROS 2 bag"));
    folder.write("metadata.yaml", "camera: left");
    EXPECT_THAT(refusal([&] { open_source(options_of(folder.path())); }), HasSubstr("holds no stereo images"));
}

TEST(BagSource, LongNamesOfTopicsAreRefused) {
    const TemporaryFolder folder;
    BagWriter bag;
    bag.image('/' + std::string(1000, 'x'), bag_start_ns, numbered_image(width, height, CV_8UC1, 1), "mono8");
    EXPECT_THAT(play_all(options_of(folder.write("a.mcap", bag.close()))).problem,
                HasSubstr("a topic whose name has 1001 bytes, allowed are up to 1000"));
}

TEST(BagSource, ABagThatWasCutOffPlaysWhatIsWhole) {
    const TemporaryFolder folder;
    disparityd::test::McapFeatures features;
    features.chunk_bytes = 10000;
    const std::string file = grey_bag(10, features);
    const Played found = play_all(options_of(folder.write("a.mcap", file.substr(0, file.size() / 2))));
    EXPECT_THAT(found.problem, HasSubstr("a.mcap: was cut off after"));
    EXPECT_GT(found.frames.size(), 2U);
    EXPECT_LT(found.frames.size(), 8U);
}

TEST(BagSource, DamageIsToldInALine) {
    const TemporaryFolder folder;
    std::mt19937 random(1);
    disparityd::test::McapFeatures features;
    features.checksums = false;
    features.chunk_bytes = 10000;
    unsigned told = 0;
    for (int i = 0; i < 300; ++i) {
        features.packing = i % 3 == 0 ? "" : i % 3 == 1 ? "zstd" : "lz4";
        features.chunks = i % 4 != 0;
        std::string file = grey_bag(4, features);
        for (int damage = 0; damage < 1 + i % 5; ++damage) {
            file[random() % file.size()] = static_cast<char>(random());
        }
        const Played found = play_all(options_of(folder.write("a.mcap", file)));
        EXPECT_LE(found.frames.size(), 4U);
        EXPECT_EQ(found.problem.find('\n'), std::string::npos) << found.problem;
        if (!found.problem.empty()) {
            ++told;
            EXPECT_THAT(found.problem, HasSubstr("a.mcap"));
            EXPECT_LT(found.problem.size(), 1000U);
        }
    }
    EXPECT_GT(told, 100U);
}

}  // namespace
}  // namespace disparityd::capture
