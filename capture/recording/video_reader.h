// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "capture/jpeg_decoder.h"
#include "capture/recording/recording_ffmpeg.h"
#include "capture/recording/recording_input.h"
#include "capture/recording/recording_pixels.h"
#include "capture/recording/recording_reader.h"

namespace disparityd::capture {

/// What the readers of native and of foreign files share: they decode one stream, packet by packet. What differs is
/// where a frame's facts come from, and which faults end the file.
class VideoReader : public RecordingReader {
public:
    const Info& info() const final { return info_; }
    std::size_t frame_bytes() const final;
    bool read(recording::FrameFacts& facts, std::uint8_t* pixels) final;

protected:
    /// Reads one stream; the derived class then completes `info_` and calls open_decoder(). Throws as
    /// open_recording_reader().
    VideoReader(RecordingInput input, int track);

    /// Pictures are expected in the pixel format `stored`. Throws std::invalid_argument when they cannot be used.
    void open_decoder(AVPixelFormat stored);

    /// In place of open_decoder(): packets are the JPEGs of a camera, with the eyes so. Throws as open_decoder().
    void open_jpegs(const EyeLayout& layout);

    /// Looks at a packet before it is decoded; false leaves it out. Throws std::runtime_error.
    virtual bool accept(const AVPacket& packet) = 0;

    /// Hears that the decoder has refused a packet, and why.
    virtual void refused(const std::string& why) = 0;

    /// Returns what belongs to the next frame. Throws std::runtime_error when there is none.
    /// `frame` is empty where the picture was a JPEG.
    virtual recording::FrameFacts take_facts(const AVFrame& frame) = 0;

    /// Looks at a frame whose pixels are there, and may complete its facts; false leaves the frame out.
    virtual bool keep(recording::FrameFacts& facts, const RawImage& image) = 0;

    /// Throws std::runtime_error when the file is damaged or ended before its time. Everything whole has been read by
    /// then.
    virtual void check_end() const = 0;

    // Faults that both know; each throws std::runtime_error.
    void check_file_size() const;
    void check_end_error() const;
    [[noreturn]] void fail_truncated(const std::string& how) const;
    [[noreturn]] void fail_damaged(const std::string& how) const;
    [[noreturn]] void fail_changed_picture(const AVFrame& frame) const;

    const RecordingInput& input() const { return input_; }
    const AVStream& stream() const { return *input_.context().streams[stream_]; }
    std::uint64_t frames() const { return frames_; }
    std::string frames_read() const;  ///< "57 of 90 frames"

    Info info_;

private:
    void check_limits() const;
    void check_size() const;
    bool next_picture(recording::FrameFacts& facts, std::uint8_t* pixels);
    bool next_jpeg(recording::FrameFacts& facts, std::uint8_t* pixels);
    bool receive_frame();
    bool read_packet();
    void send_packet();
    void check_picture() const;

    RecordingInput input_;
    int stream_ = -1;
    AVPixelFormat stored_ = AV_PIX_FMT_NONE;
    CodecPtr decoder_;
    PacketPtr packet_;
    FramePtr frame_;
    std::unique_ptr<PixelLoader> loader_;
    std::unique_ptr<JpegDecoder> jpegs_;  ///< in place of the three before

    std::uint64_t frames_ = 0;  ///< read so far
    int end_error_ = 0;         ///< with which FFmpeg ended the file
    bool draining_ = false;
    bool ended_ = false;
};

}  // namespace disparityd::capture
