// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>

#include "capture/recording/video_reader.h"

namespace disparityd::capture {

/// Reads a recording of this project (docs/recordings.md). Each packet carries the exact facts of its frame, and
/// checksums. A frame that is not as it was recorded is left out; at the end read() throws and says how many were.
class NativeReader final : public VideoReader {
public:
    /// `input` has recording::tag_format. Throws as open_recording_reader().
    NativeReader(RecordingInput input, int track);

private:
    bool accept(const AVPacket& packet) override;
    void refused(const std::string& why) override;
    recording::FrameFacts take_facts(const AVFrame& frame) override;
    bool keep(recording::FrameFacts& facts, const RawImage& image) override;
    void check_end() const override;

    void read_tags();
    void read_time_offset();
    EyeLayout read_layout() const;
    void read_calibration();
    std::string_view required_tag(const char* key) const;
    std::invalid_argument damaged_tag(const char* key) const;
    void leave_out(const std::string& why);
    void leave_out(const std::string& why, const recording::FrameFacts& facts);
    void count_gap(recording::FrameFacts& facts);

    /// What stands beside the picture of a frame.
    struct Stored {
        recording::FrameFacts facts;
        std::optional<std::uint32_t> checksum;  ///< of the picture; nothing in older recordings
    };
    std::optional<Stored> stored_of(const AVPacket& packet) const;

    bool jpegs_ = false;                          ///< frames are stored as the camera's JPEGs
    std::deque<Stored> stored_;                   ///< of the packets in the decoder
    std::optional<std::uint32_t> checksum_;       ///< of the frame that take_facts() was asked for
    std::optional<std::uint64_t> next_sequence_;  ///< if no frame is lost
    bool edited_ = false;                         ///< another program has written it anew, such as a part of it
    bool has_checksums_ = false;                  ///< every frame has, by the file's tags
    std::uint64_t left_out_ = 0;                  ///< damaged frames
    std::string left_out_why_;                    ///< of the first
    std::uint32_t left_out_before_ = 0;           ///< since the last whole frame
    std::uint32_t samples_left_out_ = 0;          ///< of the sensors, with them
};

}  // namespace disparityd::capture
