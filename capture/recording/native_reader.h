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

/// Reads a recording of this project (docs/recordings.md). Each packet carries the exact facts of its frame. Every
/// fault ends the recording.
class NativeReader final : public VideoReader {
public:
    /// `input` has recording::tag_format. Throws as open_recording_reader().
    explicit NativeReader(RecordingInput input);

private:
    bool accept(const AVPacket& packet) override;
    void refused(int error) override;
    recording::FrameFacts take_facts(const AVFrame& frame) override;
    void check_end() const override;

    void read_tags();
    void read_calibration();
    std::string_view required_tag(const char* key) const;
    std::invalid_argument damaged_tag(const char* key) const;
    void count_gap(recording::FrameFacts& facts);
    std::optional<recording::FrameFacts> facts_of(std::span<const std::uint8_t> bytes) const;

    std::deque<recording::FrameFacts> facts_;     ///< of the packets in the decoder
    std::optional<std::uint64_t> next_sequence_;  ///< if no frame is lost
    bool edited_ = false;                         ///< another program has written it anew, such as a part of it
};

}  // namespace disparityd::capture
