// SPDX-License-Identifier: Apache-2.0
//
// The made SVO2 files hold what they say: FFmpeg's own decoders give the drawn pictures back.
#include "tests/formats/svo2_writer.h"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <zstd.h>

#include "capture/recording/recording_ffmpeg.h"
#include "formats/mcap_reader.h"
#include "tests/temporary_folder.h"

namespace disparityd::test {
namespace {

using capture::CodecPtr;
using capture::FramePtr;
using capture::PacketPtr;

template <class T>
T field(const std::string& bytes, std::size_t place) {
    T value{};
    std::memcpy(&value, bytes.data() + place, sizeof value);
    return value;
}

/// The messages of a topic, in order.
std::vector<std::string> messages_of(const std::string& bytes, const std::string& topic) {
    const TemporaryFolder folder;
    formats::McapReader reader(folder.write("made.svo2", bytes));
    std::vector<std::string> found;
    formats::McapMessage message;
    while (reader.next(message)) {
        if (reader.definitions().channels().at(message.channel).topic == topic) {
            found.emplace_back(message.data.begin(), message.data.end());
        }
    }
    return found;
}

std::vector<std::string> payloads_of(const Svo2File& file) {
    std::vector<std::string> payloads;
    for (const std::string& message : messages_of(svo2_bytes(file), "Camera_SN31234567/side_by_side")) {
        EXPECT_EQ(field<std::uint32_t>(message, 0), message.size() - 4);
        EXPECT_EQ(field<std::uint32_t>(message, 4), message.size() - 8 - 56);
        payloads.push_back(message.substr(8, field<std::uint32_t>(message, 4)));
    }
    return payloads;
}

/// Decodes packet by packet: each gives its frame at once.
std::vector<FramePtr> decoded(const std::vector<std::string>& packets, AVCodecID codec) {
    const AVCodec* decoder = avcodec_find_decoder(codec);
    const CodecPtr context(avcodec_alloc_context3(decoder));
    context->flags |= AV_CODEC_FLAG_LOW_DELAY;
    context->thread_count = 1;
    EXPECT_GE(avcodec_open2(context.get(), decoder, nullptr), 0);
    std::vector<FramePtr> frames;
    for (const std::string& bytes : packets) {
        const PacketPtr packet(av_packet_alloc());
        EXPECT_GE(av_new_packet(packet.get(), static_cast<int>(bytes.size())), 0);
        std::memcpy(packet->data, bytes.data(), bytes.size());
        if (codec == AV_CODEC_ID_PNG) {
            packet->flags = AV_PKT_FLAG_KEY;  // without it FFmpeg adds the picture to the one before
        }
        EXPECT_GE(avcodec_send_packet(context.get(), packet.get()), 0);
        frames.emplace_back(av_frame_alloc());
        EXPECT_GE(avcodec_receive_frame(context.get(), frames.back().get()), 0);
    }
    return frames;
}

std::vector<std::uint8_t> plane(const AVFrame& frame, int number, int row_bytes, int rows) {
    std::vector<std::uint8_t> bytes;
    for (int y = 0; y < rows; ++y) {
        const std::uint8_t* row = frame.data[number] + y * frame.linesize[number];
        bytes.insert(bytes.end(), row, row + row_bytes);
    }
    return bytes;
}

Svo2Picture picture_of(const Svo2File& file, int number) {
    return svo2_picture(file.eye_width, file.height, file.disparity, number);
}

double mean_difference(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        sum += std::abs(a[i] - b[i]);
    }
    return sum / static_cast<double>(a.size());
}

struct Video {
    Svo2Payload payload;
    AVCodecID codec;
    bool lossless;
};

void PrintTo(const Video& video, std::ostream* out) {
    *out << avcodec_get_name(video.codec) << (video.lossless ? " without loss" : "") << ", payload "
         << static_cast<int>(video.payload);
}

class MadeVideo : public ::testing::TestWithParam<Video> {};

TEST_P(MadeVideo, FfmpegDecodesThePictures) {
    const auto [payload, codec, lossless] = GetParam();
    if (!can_write(payload)) {
        GTEST_SKIP() << "FFmpeg has no encoder for it here";
    }
    Svo2File file;
    file.payload = payload;
    file.lost = {4, 5};
    const std::vector<FramePtr> frames = decoded(payloads_of(file), codec);
    const std::vector<int> numbers = svo2_frame_numbers(file);
    ASSERT_EQ(frames.size(), 10U);
    ASSERT_EQ(numbers.size(), 10U);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const Svo2Picture picture = picture_of(file, numbers[i]);
        ASSERT_EQ(frames[i]->width, picture.width);
        ASSERT_EQ(frames[i]->height, picture.height);
        const std::vector<std::uint8_t> luma = plane(*frames[i], 0, picture.width, picture.height);
        if (lossless) {
            EXPECT_EQ(luma, picture.luma) << i;
        } else {
            EXPECT_NE(luma, picture.luma) << i;
            EXPECT_LT(mean_difference(luma, picture.luma), 4) << i;
        }
        if (lossless && frames[i]->format == AV_PIX_FMT_YUV420P) {
            EXPECT_EQ(plane(*frames[i], 1, picture.width / 2, picture.height / 2), picture.blue) << i;
            EXPECT_EQ(plane(*frames[i], 2, picture.width / 2, picture.height / 2), picture.red) << i;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Svo2, MadeVideo,
                         ::testing::Values(Video{Svo2Payload::h264, AV_CODEC_ID_H264, false},
                                           Video{Svo2Payload::h265, AV_CODEC_ID_HEVC, false},
                                           Video{Svo2Payload::h264_lossless, AV_CODEC_ID_H264, true},
                                           Video{Svo2Payload::h264_lossless_444, AV_CODEC_ID_H264, true},
                                           Video{Svo2Payload::h265_lossless, AV_CODEC_ID_HEVC, true}));

TEST(MadeSvo2, PngGivesThePicturesInColour) {
    Svo2File file;
    file.payload = Svo2Payload::png;
    const std::vector<FramePtr> frames = decoded(payloads_of(file), AV_CODEC_ID_PNG);
    ASSERT_EQ(frames.size(), 12U);
    for (int i = 0; i < 12; ++i) {
        const Svo2Picture picture = picture_of(file, i);
        EXPECT_EQ(plane(*frames[static_cast<std::size_t>(i)], 0, 3 * picture.width, picture.height), svo2_rgb(picture));
    }
}

TEST(MadeSvo2, ZstdHoldsTheRawFormats) {
    const std::pair<Svo2Payload, std::size_t> kinds[] = {{Svo2Payload::zstd_grey, 1},
                                                         {Svo2Payload::zstd_yuyv, 2},
                                                         {Svo2Payload::zstd_bgr, 3},
                                                         {Svo2Payload::zstd_bgra, 4}};
    for (const auto& [payload, pixel_bytes] : kinds) {
        Svo2File file;
        file.payload = payload;
        file.frames = 1;
        const std::string packed = payloads_of(file).at(0);
        const Svo2Picture picture = picture_of(file, 0);
        std::string raw(pixel_bytes * picture.luma.size(), '\0');
        ASSERT_EQ(ZSTD_decompress(raw.data(), raw.size(), packed.data(), packed.size()), raw.size());
        const std::size_t place = picture.luma.size() / 2 + 7;
        const std::size_t grey = pixel_bytes > 2 ? 2 : 0;  // red
        EXPECT_EQ(static_cast<std::uint8_t>(raw[place * pixel_bytes + grey]), picture.luma[place]);
    }
}

TEST(MadeSvo2, EyesDifferByTheDisparityEverywhere) {
    const Svo2File file;
    const Svo2Picture picture = picture_of(file, 3);
    for (int y = 0; y < file.height; ++y) {
        const std::uint8_t* left = picture.luma.data() + y * picture.width;
        const std::uint8_t* right = left + file.eye_width;
        for (int x = file.disparity; x < file.eye_width; ++x) {
            ASSERT_EQ(left[x], right[x - file.disparity]);
        }
    }
}

TEST(MadeSvo2, StampsComeInTheUnitAskedFor) {
    Svo2File file;
    file.payload = Svo2Payload::zstd_grey;
    file.frames = 2;
    file.stamp_unit_ns = 1'000'000;
    const std::vector<std::string> messages = messages_of(svo2_bytes(file), "Camera_SN31234567/side_by_side");
    ASSERT_EQ(messages.size(), 2U);
    EXPECT_EQ(field<std::uint64_t>(messages[1], messages[1].size() - 56 + 0x18), 1'717'000'000'156U);
    EXPECT_EQ(svo2_frame_ns(file, 1), 1'717'000'000'156'000'000U);
    EXPECT_EQ(field<std::int32_t>(messages[1], messages[1].size() - 56 + 0x30), 1);
}

TEST(MadeSvo2, ChangesReachTheirFrameOnly) {
    Svo2File file;
    file.payload = Svo2Payload::encrypted;
    file.frames = 3;
    file.change = [](std::string& message, int number) {
        if (number == 1) {
            message = "short";
        }
    };
    const std::vector<std::string> messages = messages_of(svo2_bytes(file), "Camera_SN31234567/side_by_side");
    ASSERT_EQ(messages.size(), 3U);
    EXPECT_EQ(messages[1], "short");
    EXPECT_GT(messages[0].size(), 5000U);
    EXPECT_GT(messages[2].size(), 5000U);
}

}  // namespace
}  // namespace disparityd::test
