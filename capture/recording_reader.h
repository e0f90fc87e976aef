// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "capture/recording_ffmpeg.h"
#include "capture/recording_format.h"
#include "capture/recording_pixels.h"
#include "capture/recording_segment.h"

namespace disparityd::capture {

/// Reads a recording, or any side-by-side video that FFmpeg can read, from its first frame to its last. One thread
/// uses an object at a time.
class RecordingReader {
public:
    /// Throws std::invalid_argument with one line when this is no video that can be taken, std::runtime_error when the
    /// system refuses to read it.
    explicit RecordingReader(const std::string& path);
    RecordingReader(const RecordingReader&) = delete;
    RecordingReader& operator=(const RecordingReader&) = delete;

    struct Info {
        PixelFormat format = PixelFormat::grey8;
        int eye_width = 0;
        int height = 0;
        double rate = 0;  ///< 0 = unknown
        std::optional<std::uint64_t> frame_count;
        bool ours = false;   ///< exact times, sequence and flags; not just any video
        std::string source;  ///< what was recorded
        std::string codec;
        std::optional<std::string> calibration_text;
    };
    const Info& info() const { return info_; }
    std::size_t frame_bytes() const;

    /// Reads one frame into frame_bytes() at `pixels`, rows without gaps; false after the last one. Throws
    /// std::runtime_error when the file is damaged or cut, after everything whole was read.
    bool read(recording::FrameFacts& facts, std::uint8_t* pixels);

private:
    struct CloseInput {
        void operator()(AVFormatContext* input) const { avformat_close_input(&input); }
    };

    void open_file(bool has_our_tag);
    void choose_stream();
    void read_facts_of_file();
    void read_tags();
    void open_decoder();
    void check_size() const;
    const char* tag(const char* key) const;
    std::string_view required_tag(const char* key) const;
    std::invalid_argument damaged_tag(const char* key) const;
    double foreign_rate() const;

    bool receive_frame();
    void send_packet();
    void check_packet();
    std::optional<recording::FrameFacts> facts_of(std::span<const std::uint8_t> bytes) const;
    recording::FrameFacts take_facts();
    void check_picture() const;
    void check_end() const;
    [[noreturn]] void fail_truncated(const std::string& how) const;
    std::string frames_read() const;

    std::string path_;
    std::uint64_t file_size_ = 0;
    std::optional<MatroskaSegment> segment_;
    std::unique_ptr<AVFormatContext, CloseInput> input_;
    int stream_ = -1;
    CodecPtr decoder_;
    PacketPtr packet_;
    FramePtr frame_;
    std::unique_ptr<PixelLoader> loader_;
    Info info_;

    std::deque<recording::FrameFacts> facts_;  ///< of the packets in the decoder, when the recording is ours
    std::uint64_t frames_ = 0;                 ///< read so far
    std::uint64_t next_sequence_ = 0;          ///< of a foreign video
    std::uint32_t undecodable_ = 0;            ///< packets of a foreign video since the last frame
    std::string undecodable_why_;
    bool cut_packet_ = false;  ///< the one read last is incomplete
    std::optional<std::int64_t> first_pts_;
    std::int64_t last_time_ns_ = 0;
    int end_error_ = 0;  ///< with which FFmpeg ended the file
    bool draining_ = false;
    bool ended_ = false;
};

}  // namespace disparityd::capture
