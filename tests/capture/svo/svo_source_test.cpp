// SPDX-License-Identifier: Apache-2.0
//
// SVO2 recordings as a source: what the payloads may be, times, numbers, sensors, calibration, refusals.
#include <algorithm>
#include <cstring>
#include <random>

#include <turbojpeg.h>
#include <zstd.h>

#include "base/little_endian.h"
#include "capture/frame_source.h"
#include "capture/recording/recording_ffmpeg.h"
#include "capture/svo/svo_picture.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/played_source.h"
#include "tests/formats/mcap_writer.h"
#include "tests/formats/refusal.h"
#include "tests/temporary_folder.h"

namespace disparityd::capture {
namespace {

using disparityd::test::McapWriter;
using disparityd::test::TemporaryFolder;
using test::numbered_image;
using test::play_all;
using test::Played;
using test::refusal;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int svo_width = 128;  // of both eyes
constexpr int svo_height = 48;
constexpr std::uint64_t start_ns = 1'738'434'526'000'000'000;
constexpr std::uint64_t period_ns = 40'000'000;

std::string little_endian(std::uint64_t value, std::size_t bytes) {
    std::string text(bytes, '\0');
    base::put_little_endian(reinterpret_cast<std::uint8_t*>(text.data()), value, bytes);
    return text;
}

std::string base64(const std::string& bytes) {
    constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
        for (std::size_t k = 0; k < 3; ++k) {
            bits = (bits << 8U) | (k < have ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text += k <= have ? digits[(bits >> (18 - 6 * k)) & 63U] : '=';
        }
    }
    return text;
}

/// Makes an SVO2 file with the least that a reader needs.
class Svo {
public:
    explicit Svo(const std::string& header_entries = "", disparityd::test::McapFeatures features = {})
        : file_(std::move(features), "") {
        header_ = file_.channel(0, "svo_header", "json");
        video_ = file_.channel(0, "Camera_SN4711/side_by_side", "zed_sdk_encoded");
        sensors_ = file_.channel(0, "Camera_SN4711/sensors", "json");
        const std::string structure =
            little_endian(svo_width, 4) + little_endian(svo_height, 4) + little_endian(4711, 4) + little_endian(25, 4);
        file_.message(header_, 0, 0,
                      R"({"zed_sdk_version": "4.1.2", )" + header_entries + R"("header": ")" +
                          base64(structure + std::string(112, '\0')) + "\"}");
    }

    void video(const std::string& payload, int index, std::uint64_t stamp) {
        std::string footer(56, '\0');
        footer.replace(0, 8, little_endian(svo_width, 4) + little_endian(svo_height, 4));
        footer.replace(0x18, 12, little_endian(stamp, 8) + little_endian(payload.size(), 4));
        footer.replace(0x30, 4, little_endian(static_cast<std::uint32_t>(index), 4));
        const std::string rest = little_endian(payload.size(), 4) + payload + footer;
        message(video_, little_endian(rest.size(), 4) + rest);
    }

    void video(const std::string& payload, int index) {
        video(payload, index, start_ns + static_cast<std::uint64_t>(index) * period_ns);
    }

    void sample(std::uint64_t stamp, float degrees, const std::string& topic = "") {
        std::string structure(360, '\0');
        structure.replace(0x10, 8, little_endian(stamp, 8));
        std::memcpy(structure.data() + 0x58, &degrees, sizeof degrees);
        const float acceleration = 9.5F;
        std::memcpy(structure.data() + 0x68, &acceleration, sizeof acceleration);
        message(topic.empty() ? sensors_ : file_.channel(0, topic, "json"),
                R"({"data": ")" + base64(structure) + "\"}");
    }

    void sensor_message(const std::string& text) { message(sensors_, text); }
    void header_message(const std::string& text) { message(header_, text); }
    void raw_video(const std::string& bytes) { message(video_, bytes); }
    void other_topic() { message(file_.channel(0, "Camera_SN4711/else", "json"), "{}"); }
    std::string close() { return file_.close(); }

private:
    void message(std::uint16_t channel, const std::string& data) {
        file_.message(channel, 0, 5'000'000'000 + 1'000'000 * ++count_, data);
    }

    McapWriter file_;
    std::uint16_t header_ = 0, video_ = 0, sensors_ = 0;
    std::uint64_t count_ = 0;
};

std::string png(const cv::Mat& image) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(".png", image, bytes);
    return {bytes.begin(), bytes.end()};
}

std::string zstd(const cv::Mat& image) {
    const std::size_t size = image.total() * image.elemSize();
    std::string packed(ZSTD_compressBound(size), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), image.data, size, 1));
    return packed;
}

/// Strips of JPEG behind their sizes, whose rows are constant so that they stay as they are.
std::string jpeg_strips(const cv::Mat& image, int strips) {
    std::string sizes, all;
    const auto encoder = tjInitCompress();
    for (int i = 0; i < strips; ++i) {
        const cv::Mat part = image.rowRange(i * image.rows / strips, (i + 1) * image.rows / strips);
        unsigned char* bytes = nullptr;
        unsigned long size = 0;
        EXPECT_EQ(
            tjCompress2(encoder, part.data, part.cols, 0, part.rows, TJPF_GRAY, &bytes, &size, TJSAMP_GRAY, 100, 0), 0);
        sizes += little_endian(size, 8);
        all.append(reinterpret_cast<char*>(bytes), size);
        tjFree(bytes);
    }
    tjDestroy(encoder);
    return sizes + all;
}

/// Encodes pictures without loss and returns an access unit for each.
std::vector<std::string> encode(AVCodecID id, const std::vector<cv::Mat>& images) {
    std::vector<std::string> units;
    const AVCodec* codec = avcodec_find_encoder(id);
    if (codec == nullptr) {
        return units;
    }
    const CodecPtr encoder(avcodec_alloc_context3(codec));
    encoder->width = svo_width;
    encoder->height = svo_height;
    encoder->pix_fmt = AV_PIX_FMT_YUV420P;
    encoder->time_base = {1, 25};
    encoder->max_b_frames = 0;
    encoder->gop_size = 3;
    AVDictionary* options = nullptr;
    av_dict_set(&options, "preset", "ultrafast", 0);
    av_dict_set(&options, id == AV_CODEC_ID_H264 ? "qp" : "x265-params",
                id == AV_CODEC_ID_H264 ? "0" : "lossless=1:log-level=none", 0);
    EXPECT_GE(avcodec_open2(encoder.get(), codec, &options), 0);
    av_dict_free(&options);
    const PacketPtr packet(av_packet_alloc());
    for (std::size_t i = 0; i <= images.size(); ++i) {
        FramePtr frame;
        if (i < images.size()) {
            frame.reset(av_frame_alloc());
            frame->width = svo_width;
            frame->height = svo_height;
            frame->format = AV_PIX_FMT_YUV420P;
            frame->pts = static_cast<std::int64_t>(i);
            av_frame_get_buffer(frame.get(), 0);
            for (int y = 0; y < svo_height; ++y) {
                std::memcpy(frame->data[0] + y * frame->linesize[0], images[i].ptr(y), svo_width);
            }
            for (int plane = 1; plane < 3; ++plane) {
                std::memset(frame->data[plane], 128, static_cast<std::size_t>(frame->linesize[plane] * svo_height / 2));
            }
        }
        avcodec_send_frame(encoder.get(), frame.get());
        while (avcodec_receive_packet(encoder.get(), packet.get()) >= 0) {
            units.emplace_back(reinterpret_cast<char*>(packet->data), static_cast<std::size_t>(packet->size));
            av_packet_unref(packet.get());
        }
    }
    return units;
}

Played play(const std::string& content, const std::string& name = "a.svo2") {
    const TemporaryFolder folder;
    SourceOptions options;
    options.uri = folder.write(name, content);
    return play_all(options);
}

std::vector<std::uint8_t> bytes_of(const cv::Mat& image) {
    return {image.data, image.data + image.total() * image.elemSize()};
}

TEST(SvoSource, TakesPicturesThatArePackedWithoutLoss) {
    const cv::Mat grey = numbered_image(svo_width, svo_height, CV_8UC1, 1);
    const cv::Mat bgr = numbered_image(svo_width, svo_height, CV_8UC3, 2);
    const cv::Mat yuyv = numbered_image(svo_width, svo_height, CV_8UC2, 3);
    cv::Mat flat(svo_height, 2 * svo_width, CV_8UC1, cv::Scalar(90));
    struct Case {
        std::string payload;
        PixelFormat format;
        cv::Mat pixels;
    };
    for (const Case& one : {Case{png(grey), PixelFormat::grey8, grey},
                            {png(bgr), PixelFormat::bgr24, bgr},
                            {png(yuyv.reshape(1)), PixelFormat::yuyv, yuyv},
                            {zstd(grey), PixelFormat::grey8, grey},
                            {zstd(yuyv), PixelFormat::yuyv, yuyv},
                            {zstd(bgr), PixelFormat::bgr24, bgr},
                            {jpeg_strips(flat, 4), PixelFormat::yuyv, flat}}) {
        Svo file;
        file.video(one.payload, 0);
        file.video(one.payload, 1);
        const Played played = play(file.close());
        EXPECT_EQ(played.problem, "");
        ASSERT_EQ(played.frames.size(), 2U);
        EXPECT_EQ(played.info.format, one.format);
        EXPECT_EQ(played.info.eye_width, svo_width / 2);
        EXPECT_EQ(played.info.height, svo_height);
        EXPECT_EQ(played.info.rate, 25);
        EXPECT_TRUE(played.frames[1] == bytes_of(one.pixels));
    }
}

TEST(SvoSource, TakesJpegsWithoutSizesOfTheMessage) {
    const cv::Mat flat(svo_height, 2 * svo_width, CV_8UC1, cv::Scalar(90));
    Svo file;
    for (int i = 0; i < 2; ++i) {
        file.raw_video(little_endian(0xFFFFFF00U, 4) + little_endian(0xFFFFFF3CU, 4) + jpeg_strips(flat, 4));
    }
    const Played played = play(file.close());
    EXPECT_EQ(played.problem, "");
    ASSERT_EQ(played.frames.size(), 2U);
    EXPECT_TRUE(played.frames[1] == bytes_of(flat));
    EXPECT_EQ(played.times[1] - played.times[0], 1'000'000) << "those of the container";
}

TEST(SvoSource, DecodesVideo) {
    for (const auto& [id, name] : {std::pair(AV_CODEC_ID_H264, "H.264"), {AV_CODEC_ID_HEVC, "H.265"}}) {
        std::vector<cv::Mat> images;
        for (int i = 0; i < 8; ++i) {
            images.push_back(numbered_image(svo_width, svo_height, CV_8UC1, i));
        }
        const auto units = encode(id, images);
        if (units.empty()) {
            continue;  // this FFmpeg has no encoder
        }
        ASSERT_EQ(units.size(), images.size());
        Svo file;
        for (int i = 0; i < 8; ++i) {
            file.video(units[static_cast<std::size_t>(i)], i);
        }
        const Played played = play(file.close());
        EXPECT_EQ(played.problem, "");
        ASSERT_EQ(played.frames.size(), images.size());
        for (std::size_t i = 0; i < images.size(); ++i) {
            EXPECT_TRUE(played.frames[i] == bytes_of(images[i])) << name << i;
            EXPECT_EQ(played.times[i], static_cast<std::int64_t>(start_ns + i * period_ns));
        }
        EXPECT_THAT(played.info.description, HasSubstr(name));
        EXPECT_THAT(played.notices, Contains(HasSubstr("lossy")));
        EXPECT_THAT(played.notices, Contains(HasSubstr("experimental")));
    }
}

TEST(SvoSource, LeavesOutWhatItDoesNotUnderstandAndTellsIt) {
    std::vector<cv::Mat> images(8, numbered_image(svo_width, svo_height, CV_8UC1, 1));
    const auto units = encode(AV_CODEC_ID_H264, images);
    if (units.empty()) {
        GTEST_SKIP() << "this FFmpeg has no encoder for H.264";
    }
    Svo file;
    for (int i = 0; i < 8; ++i) {
        file.video(i == 1 ? "what is this" : units[static_cast<std::size_t>(i)], i);
    }
    const Played played = play(file.close());
    EXPECT_THAT(played.sequences, ElementsAre(0, 3, 4, 5, 6, 7)) << "2 builds on 1";
    EXPECT_THAT(played.lost, ElementsAre(0, 2, 0, 0, 0, 0));
    EXPECT_THAT(played.problem, AllOf(HasSubstr("2 of 8 video messages gave no frame"), HasSubstr("77 68 61 74")));
}

TEST(SvoSource, CountsFramesByTheirNumbers) {
    const std::string payload = png(numbered_image(svo_width, svo_height, CV_8UC1, 1));
    Svo file;
    for (const int index : {7, 8, 12, 13}) {
        file.video(payload, index);
    }
    const Played played = play(file.close());
    EXPECT_THAT(played.sequences, ElementsAre(7, 8, 12, 13));
    EXPECT_THAT(played.lost, ElementsAre(0, 0, 3, 0));
}

TEST(SvoSource, TellsTheUnitOfStampsByTheirMagnitude) {
    const std::string payload = png(numbered_image(svo_width, svo_height, CV_8UC1, 1));
    for (const std::uint64_t unit_ns : {1ULL, 1000ULL, 1'000'000ULL}) {
        Svo file;
        file.video(payload, 0, start_ns / unit_ns);
        file.video(payload, 1, (start_ns + period_ns) / unit_ns);
        const Played played = play(file.close());
        EXPECT_THAT(played.times, ElementsAre(start_ns, start_ns + period_ns)) << unit_ns;
    }
    Svo without;
    without.video(payload, 0, 12345);
    without.video(payload, 1, 12346);
    const Played played = play(without.close());
    ASSERT_EQ(played.times.size(), 2U);
    EXPECT_EQ(played.times[1] - played.times[0], 1'000'000) << "those of the container";
}

TEST(SvoSource, GivesInertialSamples) {
    const std::string payload = png(numbered_image(svo_width, svo_height, CV_8UC1, 1));
    Svo file;
    file.video(payload, 0);
    file.sensor_message("{}");
    file.sample(start_ns + 10'000'000, 180);
    file.video(payload, 1);
    file.sample(start_ns / 1'000'000 + 60, 90);
    file.video(payload, 2);
    const Played played = play(file.close());
    EXPECT_THAT(played.problem,
                HasSubstr("1 message of the sensors gave no sample, the first because it has no structure"));
    ASSERT_EQ(played.samples.size(), 2U);
    EXPECT_EQ(played.samples[0].flags, sensor_flag_inertial);
    EXPECT_EQ(played.samples[0].lost_before, 1U);
    EXPECT_FLOAT_EQ(played.samples[0].angular_velocity.x, 3.14159265F);
    EXPECT_FLOAT_EQ(played.samples[0].acceleration.y, 9.5F);
    EXPECT_EQ(played.samples[0].monotonic_ns, 10'000'000);
    EXPECT_EQ(played.samples[1].realtime_ns, static_cast<std::int64_t>(start_ns + 60'000'000));
    EXPECT_THAT(played.notices, Contains(HasSubstr("a message of the sensors is not understood")));
}

TEST(SvoSource, TakesTheSensorsOfTheCameraOfTheVideo) {
    const std::string payload = png(numbered_image(svo_width, svo_height, CV_8UC1, 1));
    Svo file;
    file.sample(start_ns, 1, "Camera_SN4712/sensors");
    file.video(payload, 0);
    file.sample(start_ns + 10'000'000, 180);
    file.sample(start_ns + 20'000'000, 1, "Camera_SN4712/sensors");
    file.video(payload, 1);
    const Played played = play(file.close());
    EXPECT_EQ(played.problem, "");
    ASSERT_EQ(played.samples.size(), 1U);
    EXPECT_FLOAT_EQ(played.samples[0].angular_velocity.x, 3.14159265F);
    EXPECT_THAT(played.notices, Contains(HasSubstr("of another camera, and not read: Camera_SN4712/sensors")));
}

TEST(SvoSource, TellsOnceThatHeadersAreNotUnderstood) {
    Svo file;
    for (int i = 0; i < 3; ++i) {
        file.header_message("no JSON");
    }
    file.video(png(numbered_image(svo_width, svo_height, CV_8UC1, 1)), 0);
    const Played played = play(file.close());
    EXPECT_EQ(std::count_if(played.notices.begin(), played.notices.end(),
                            [](const std::string& line) {
                                return line.find("the header is not understood") != std::string::npos;
                            }),
              1);
}

TEST(SvoSource, PicturesPackedByZstdFitTheirSize) {
    const auto unpacked = [](int bytes, SvoSize size) {
        const std::string packed = zstd(cv::Mat(1, bytes, CV_8UC1, cv::Scalar(7)));
        return unpack_svo_picture(SvoPayload::zstd,
                                  {reinterpret_cast<const std::uint8_t*>(packed.data()), packed.size()}, size);
    };
    EXPECT_EQ(unpacked(192, {16, 8}).pixels.rows, 8) << "NV12";
    EXPECT_THAT(disparityd::test::refusal([&] { unpacked(12288, {8192, 1}); }), HasSubstr("zstd holds 12288 bytes"));
    EXPECT_THAT(disparityd::test::refusal([&] { unpacked(27, {6, 3}); }), HasSubstr("zstd holds 27 bytes"));
    EXPECT_THAT(disparityd::test::refusal([&] { unpacked(21, {7, 2}); }), HasSubstr("does not hold two eyes"));
}

TEST(SvoSource, FindsTheCalibrationBySerialNumber) {
    const TemporaryFolder folder;
    Svo file;
    file.other_topic();
    for (int i = 0; i < 2; ++i) {
        file.video(png(numbered_image(svo_width, svo_height, CV_8UC1, i)), i);
    }
    SourceOptions options;
    options.uri = folder.write("a.svo2", file.close());
    options.calibration_folders = {folder.path()};
    Played played = play_all(options);
    EXPECT_FALSE(played.info.calibration);
    EXPECT_THAT(played.notices, Contains(AllOf(HasSubstr("serial number 4711"), HasSubstr("SN4711.conf"))));
    EXPECT_THAT(played.notices, Contains(HasSubstr("and not read: Camera_SN4711/else (1 message)")));

    calibration::StereoCalibration calibration;
    calibration.width = svo_width / 2;
    calibration.height = svo_height;
    calibration.left = calibration.right = {60, 60, 31.5, 23.5, {}};
    calibration.translation = {-120, 0, 0};
    folder.write("4711.yml", calibration::to_opencv_yaml(calibration));
    played = play_all(options);
    ASSERT_TRUE(played.info.calibration) << played.problem;
    EXPECT_NEAR(played.info.calibration->translation[0], -120, 1e-9);
    EXPECT_THAT(played.info.calibration->origin, HasSubstr("4711.yml"));
    EXPECT_EQ(played.info.serial, "4711");
}

TEST(SvoSource, RefusesInOneLineWhatItCannotRead) {
    Svo unknown;
    unknown.video("\x11\x22 secret", 0);
    EXPECT_THAT(play(unknown.close()).problem, AllOf(HasSubstr("a.svo2: no frame can be read"),
                                                     HasSubstr("bytes 11 22 20 73"), HasSubstr("encrypted")));
    Svo encrypted("\"Encryption\": true, ");
    encrypted.video("\x11\x22", 0);
    EXPECT_THAT(play(encrypted.close()).problem, HasSubstr("is an encrypted recording"));
    EXPECT_THAT(play(std::string("\0SVO", 4) + std::string(2000, 'x')).problem, HasSubstr("SVO 1"));
    EXPECT_THAT(play(std::string("\0SVO", 4) + std::string(2000, 'x'), "a.svo").problem, HasSubstr("SVO 1"));
    EXPECT_THAT(play(std::string(2000, 'x')).problem, AllOf(HasSubstr("encrypted"), HasSubstr("78 78 78")));
    EXPECT_THAT(play("").problem, HasSubstr("is empty"));
    EXPECT_THAT(play(Svo().close()).problem, HasSubstr("holds no video of a ZED camera"));
    EXPECT_THAT(refusal([] {
                    SourceOptions options;
                    options.uri = "/nowhere/a.svo2";
                    open_source(options);
                }),
                HasSubstr("no such file"));
    Svo mcap;
    mcap.video(png(numbered_image(svo_width, svo_height, CV_8UC1, 1)), 0);
    EXPECT_EQ(play(mcap.close(), "a.svo").problem, "") << "SVO2 under the old name";
}

TEST(SvoSource, ManyDamagedFilesEndInALine) {
    const auto units = encode(AV_CODEC_ID_H264, {6, numbered_image(svo_width, svo_height, CV_8UC1, 1)});
    disparityd::test::McapFeatures unchecked;  // so that damage reaches the messages
    unchecked.checksums = false;
    Svo file("", unchecked);
    for (int i = 0; i < 6; ++i) {
        file.sample(start_ns, 1);
        file.video(units.empty() || i > 2 ? png(numbered_image(svo_width, svo_height, CV_8UC1, i))
                                          : units[static_cast<std::size_t>(i)],
                   i);
    }
    const std::string whole = file.close();
    std::mt19937 random(7);
    for (int i = 0; i < 300; ++i) {
        std::string damaged = whole.substr(0, i % 3 == 0 ? random() % whole.size() : whole.size());
        for (int k = 0; k < 4 && !damaged.empty(); ++k) {
            damaged[random() % damaged.size()] = static_cast<char>(random());
        }
        const Played played = play(damaged);
        EXPECT_LE(played.frames.size(), 6U);
    }
}

}  // namespace
}  // namespace disparityd::capture
