// SPDX-License-Identifier: Apache-2.0
// Measures lossless codecs for recordings: CPU time of one thread per frame and size. docs/recordings.md has the
// table. With two image files it takes them as the left and right eye, otherwise it makes textured, noisy frames.
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
}

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <unistd.h>

#include "capture/recording/recording_source.h"
#include "capture/recording/recording_writer.h"

namespace {

struct Candidate {
    std::string codec;
    std::vector<std::pair<std::string, std::string>> options;
};

using FramePtr = std::unique_ptr<AVFrame, void (*)(AVFrame*)>;
using PacketPtr = std::unique_ptr<AVPacket, void (*)(AVPacket*)>;

FramePtr new_frame() {
    return {av_frame_alloc(), [](AVFrame* f) { av_frame_free(&f); }};
}

PacketPtr new_packet() {
    return {av_packet_alloc(), [](AVPacket* p) { av_packet_free(&p); }};
}

double thread_cpu_ms() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

/// Gradient, blobs of texture at several scales, and sensor noise of about 2 grey levels.
cv::Mat made_image(int width, int height, unsigned seed) {
    cv::Mat sum(height, width, CV_32FC3);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto fx = static_cast<float>(x);
            const auto fy = static_cast<float>(y);
            sum.at<cv::Vec3f>(y, x) = {60 + 0.05F * fx, 80 + 0.08F * fy, 70 + 0.03F * (fx + fy)};
        }
    }
    cv::RNG rng(seed);
    for (const double sigma : {1.5, 4.0, 16.0}) {
        cv::Mat texture(height, width, CV_32FC3);
        rng.fill(texture, cv::RNG::NORMAL, 0, 12 * 2 * sigma);
        cv::GaussianBlur(texture, texture, {}, sigma);
        sum += texture;
    }
    cv::Mat noise(height, width, CV_32FC3);
    rng.fill(noise, cv::RNG::NORMAL, 0, 2);
    sum += noise;
    cv::Mat image;
    sum.convertTo(image, CV_8UC3);
    return image;
}

FramePtr to_frame(const cv::Mat& bgr, AVPixelFormat format) {
    FramePtr frame = new_frame();
    frame->width = bgr.cols;
    frame->height = bgr.rows;
    frame->format = format;
    if (av_frame_get_buffer(frame.get(), 0) < 0) {
        throw std::runtime_error("out of memory");
    }
    cv::Mat yuv;
    cv::cvtColor(bgr, yuv, cv::COLOR_BGR2YUV);
    for (int y = 0; y < bgr.rows; ++y) {
        for (int x = 0; x < bgr.cols; ++x) {
            const auto& p = bgr.at<cv::Vec3b>(y, x);
            const auto& q = yuv.at<cv::Vec3b>(y, x);
            auto put = [&](int plane, int at, std::uint8_t value) {
                frame->data[plane][y * frame->linesize[plane] + at] = value;
            };
            if (format == AV_PIX_FMT_GBRP) {
                put(0, x, p[1]), put(1, x, p[0]), put(2, x, p[2]);
            } else if (format == AV_PIX_FMT_BGR0 || format == AV_PIX_FMT_BGRA) {
                put(0, 4 * x, p[0]), put(0, 4 * x + 1, p[1]), put(0, 4 * x + 2, p[2]), put(0, 4 * x + 3, 255);
            } else {
                put(0, x, q[0]);
                if (format == AV_PIX_FMT_YUV422P && x % 2 == 0) {
                    put(1, x / 2, q[1]), put(2, x / 2, q[2]);
                }
            }
        }
    }
    return frame;
}

AVCodecContext* open(const AVCodec* codec, const AVFrame& like, const Candidate& candidate,
                     const AVCodecContext* from) {
    AVCodecContext* context = avcodec_alloc_context3(codec);
    context->width = like.width;
    context->height = like.height;
    context->pix_fmt = static_cast<AVPixelFormat>(like.format);
    context->time_base = {1, 1000};
    context->thread_count = 1;
    if (from != nullptr) {
        context->extradata = static_cast<std::uint8_t*>(
            av_mallocz(static_cast<std::size_t>(from->extradata_size) + AV_INPUT_BUFFER_PADDING_SIZE));
        std::copy_n(from->extradata, from->extradata_size, context->extradata);
        context->extradata_size = from->extradata_size;
        context->codec_tag = from->codec_tag;
    } else {
        for (const auto& [key, value] : candidate.options) {
            av_opt_set(context, key.c_str(), value.c_str(), AV_OPT_SEARCH_CHILDREN);
        }
    }
    if (avcodec_open2(context, codec, nullptr) < 0) {
        avcodec_free_context(&context);
    }
    return context;
}

void measure(const Candidate& candidate, const char* what, const std::vector<cv::Mat>& images, AVPixelFormat format) {
    const AVCodec* encoder = avcodec_find_encoder_by_name(candidate.codec.c_str());
    if (encoder == nullptr) {
        return;
    }
    std::vector<FramePtr> frames;
    for (const cv::Mat& image : images) {
        frames.push_back(to_frame(image, format));
    }
    AVCodecContext* out = open(encoder, *frames[0], candidate, nullptr);
    if (out == nullptr) {
        return;
    }
    AVCodecContext* in = open(avcodec_find_decoder(encoder->id), *frames[0], candidate, out);
    const int rounds = 12;
    double bytes = 0;
    std::vector<double> encode;
    std::vector<double> decode;
    FramePtr decoded = new_frame();
    PacketPtr packet = new_packet();
    for (int i = 0; i < rounds; ++i) {
        AVFrame* frame = frames[static_cast<std::size_t>(i) % frames.size()].get();
        frame->pts = i;
        const double t0 = thread_cpu_ms();
        if (avcodec_send_frame(out, frame) < 0 || avcodec_receive_packet(out, packet.get()) < 0) {
            throw std::runtime_error(candidate.codec + " does not encode at once");
        }
        const double t1 = thread_cpu_ms();
        bytes += packet->size;
        if (avcodec_send_packet(in, packet.get()) < 0 || avcodec_receive_frame(in, decoded.get()) < 0) {
            throw std::runtime_error(candidate.codec + " does not decode at once");
        }
        encode.push_back(t1 - t0);
        decode.push_back(thread_cpu_ms() - t1);
        av_packet_unref(packet.get());
    }
    std::nth_element(encode.begin(), encode.begin() + rounds / 2, encode.end());
    std::nth_element(decode.begin(), decode.begin() + rounds / 2, decode.end());
    std::string settings;
    for (const auto& [key, value] : candidate.options) {
        settings += (settings.empty() ? "" : " ") + key + "=" + value;
    }
    std::printf("| %-5s | %-8s | %-24s | %6.1f | %6.1f | %6.2f |\n", what, candidate.codec.c_str(), settings.c_str(),
                encode[rounds / 2], decode[rounds / 2], bytes / rounds / 1e6);
    avcodec_free_context(&out);
    avcodec_free_context(&in);
}

/// The whole way to a file in the temporary folder and back, yuyv.
void measure_recording(const std::vector<cv::Mat>& images) {
    using namespace disparityd;
    const std::string path =
        (std::filesystem::temp_directory_path() / ("record_codecs." + std::to_string(getpid()) + ".mkv")).string();
    capture::SourceInfo info;
    info.format = PixelFormat::yuyv;
    info.eye_width = images[0].cols / 2;
    info.height = images[0].rows;
    info.rate = 30;
    std::vector<std::vector<std::uint8_t>> frames;
    for (const cv::Mat& image : images) {
        const FramePtr planar = to_frame(image, AV_PIX_FMT_YUV422P);
        std::vector<std::uint8_t> packed;
        for (int y = 0; y < image.rows; ++y) {
            for (int x = 0; x < image.cols; ++x) {
                packed.push_back(planar->data[0][y * planar->linesize[0] + x]);
                const int chroma = x % 2 + 1;
                packed.push_back(planar->data[chroma][y * planar->linesize[chroma] + x / 2]);
            }
        }
        frames.push_back(packed);
    }
    constexpr int count = 60;
    capture::RecordingWriter writer(path, info, true);
    const double before = thread_cpu_ms();
    for (int i = 0; i < count; ++i) {
        capture::RawFrame frame;
        frame.image = {frames[static_cast<std::size_t>(i) % frames.size()].data(), info.format, info.eye_width,
                       info.height, 4 * info.eye_width};
        frame.monotonic_ns = i * 33'333'333LL;
        writer.write(frame);
    }
    writer.close();
    const double write_ms = (thread_cpu_ms() - before) / count;
    const double megabytes = static_cast<double>(writer.bytes()) / 1e6 / count;
    capture::SourceOptions options;
    options.uri = path;
    options.pace = capture::Pace::fastest;
    const auto start = std::chrono::steady_clock::now();
    const auto source = capture::open_recording(options);
    capture::RawFrame frame;
    int played = 0;
    while (source->next(frame, std::chrono::steady_clock::time_point::max()) == capture::FrameSource::Next::frame) {
        source->give_back(frame);
        ++played;
    }
    const std::chrono::duration<double, std::milli> replay = std::chrono::steady_clock::now() - start;
    std::filesystem::remove(path);
    std::printf("\nrecording, yuyv: %.1f ms of CPU to write a frame, %.1f ms to replay one, %.2f MB\n", write_ms,
                replay.count() / played, megabytes);
}

void run(int argc, char** argv) {
    std::vector<cv::Mat> images;
    if (argc == 3) {
        cv::Mat pair;
        cv::hconcat(cv::imread(argv[1], cv::IMREAD_COLOR), cv::imread(argv[2], cv::IMREAD_COLOR), pair);
        images.push_back(pair);
    } else {
        for (unsigned seed = 1; seed <= 3; ++seed) {
            images.push_back(made_image(2560, 720, seed));
        }
    }
    std::printf("%d x %d\n| input | codec    | options                  | enc ms | dec ms |     MB |\n", images[0].cols,
                images[0].rows);
    std::puts("| ----- | -------- | ------------------------ | -----: | -----: | -----: |");
    const std::vector<Candidate> candidates{
        {"ffvhuff", {{"pred", "left"}}},
        {"ffvhuff", {{"pred", "left"}, {"context", "1"}}},
        {"ffvhuff", {{"pred", "plane"}}},
        {"ffvhuff", {{"pred", "median"}}},
        {"ffvhuff", {{"pred", "median"}, {"context", "1"}}},
        {"utvideo", {{"pred", "left"}}},
        {"utvideo", {{"pred", "median"}}},
        {"ffv1", {{"level", "3"}, {"slices", "4"}}},
        {"ffv1", {{"level", "3"}, {"slices", "16"}}},
        {"ffv1", {{"level", "3"}, {"slices", "16"}, {"coder", "range_tab"}, {"context", "1"}}},
    };
    for (const Candidate& candidate : candidates) {
        measure(candidate, "yuyv", images, AV_PIX_FMT_YUV422P);
    }
    for (const Candidate& candidate : candidates) {
        measure(candidate, "grey8", images, AV_PIX_FMT_GRAY8);
    }
    for (const Candidate& candidate : candidates) {
        measure(candidate, "bgr24", images, candidate.codec == "ffv1" ? AV_PIX_FMT_BGR0 : AV_PIX_FMT_GBRP);
    }
    measure_recording(images);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        av_log_set_level(AV_LOG_QUIET);
        run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "record_codecs: error: %s\n", error.what());
        return 1;
    }
}
