// SPDX-License-Identifier: Apache-2.0
#include "tests/capture/recording/video_fixture.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

#include <vector>

#include <gtest/gtest.h>

namespace disparityd::capture::test {
namespace {

constexpr int brighter = 60;  // the second track

void fill(AVFrame& frame, int number, int track) {
    const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
    for (int c = 0; c < description->nb_components; ++c) {
        const AVComponentDescriptor& component = description->comp[c];
        const bool chroma = (c == 1 || c == 2) && (description->flags & AV_PIX_FMT_FLAG_RGB) == 0;
        const int width = chroma ? -(-frame.width >> description->log2_chroma_w) : frame.width;
        const int height = chroma ? -(-frame.height >> description->log2_chroma_h) : frame.height;
        for (int y = 0; y < height; ++y) {
            std::uint8_t* row = frame.data[component.plane] + y * frame.linesize[component.plane] + component.offset;
            for (int x = 0; x < width; ++x) {
                row[x * component.step] = static_cast<std::uint8_t>(value_at(number, c, x, y) + brighter * track);
            }
        }
    }
}

CodecPtr open_video_encoder(const Video& video, bool global_header) {
    const AVCodec* codec = avcodec_find_encoder(video.codec);
    CodecPtr encoder(avcodec_alloc_context3(codec));
    encoder->width = video.width;
    encoder->height = video.height;
    encoder->pix_fmt = video.pixels;
    encoder->time_base = {1, video_rate};
    encoder->framerate = {video_rate, 1};
    encoder->strict_std_compliance = FF_COMPLIANCE_UNOFFICIAL;
    encoder->flags |= global_header ? AV_CODEC_FLAG_GLOBAL_HEADER : 0;
    EXPECT_GE(avcodec_open2(encoder.get(), codec, nullptr), 0);
    return encoder;
}

}  // namespace

std::uint8_t value_at(int frame, int component, int x, int y) {
    return static_cast<std::uint8_t>(40 + 20 * component + 7 * frame + 2 * x + y);
}

void write_video(const std::string& path, const Video& video) {
    AVFormatContext* muxer = nullptr;
    ASSERT_GE(avformat_alloc_output_context2(&muxer, nullptr, video.muxer, path.c_str()), 0);
    std::vector<CodecPtr> encoders;
    for (int track = 0; track < video.tracks; ++track) {
        encoders.push_back(open_video_encoder(video, (muxer->oformat->flags & AVFMT_GLOBALHEADER) != 0));
        AVStream* stream = avformat_new_stream(muxer, nullptr);
        avcodec_parameters_from_context(stream->codecpar, encoders.back().get());
        stream->time_base = encoders.back()->time_base;
        stream->avg_frame_rate = encoders.back()->framerate;
        if (video.adjust) {
            video.adjust(*stream, track);
        }
    }
    ASSERT_GE(avio_open(&muxer->pb, path.c_str(), AVIO_FLAG_WRITE), 0);
    ASSERT_GE(avformat_write_header(muxer, nullptr), 0);
    const PacketPtr packet(av_packet_alloc());
    for (int i = 0; i <= video.frames; ++i) {
        for (int track = 0; track < video.tracks; ++track) {
            AVCodecContext* encoder = encoders[static_cast<std::size_t>(track)].get();
            FramePtr frame;
            if (i < video.frames) {
                frame.reset(av_frame_alloc());
                frame->width = video.width;
                frame->height = video.height;
                frame->format = video.pixels;
                frame->pts = i;
                ASSERT_GE(av_frame_get_buffer(frame.get(), 0), 0);
                fill(*frame, i, track);
            }
            avcodec_send_frame(encoder, frame.get());
            while (avcodec_receive_packet(encoder, packet.get()) >= 0) {
                av_packet_rescale_ts(packet.get(), encoder->time_base, muxer->streams[track]->time_base);
                packet->stream_index = track;
                ASSERT_GE(av_write_frame(muxer, packet.get()), 0);
                av_packet_unref(packet.get());
            }
        }
    }
    ASSERT_GE(av_write_trailer(muxer), 0);
    avio_closep(&muxer->pb);
    avformat_free_context(muxer);
}

}  // namespace disparityd::capture::test
