// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "capture/recording/video_reader.h"

namespace disparityd::capture {

/// Reads a video of another program. Its container gives the times. A picture that cannot be decoded is a lost frame,
/// and reading goes on. What the video declares about the place of the eyes and about a rotation is what is expected,
/// or it is refused.
class ForeignReader final : public VideoReader {
public:
    enum class Picture : unsigned char {
        both_eyes,  ///< side by side
        one_eye,    ///< halves of it are given as if they were eyes: for PairReader
    };

    /// The input is probed. Throws as open_recording_reader().
    ForeignReader(RecordingInput input, int track, Picture picture);

private:
    bool accept(const AVPacket& packet) override;
    void refused(const std::string& why) override;
    recording::FrameFacts take_facts(const AVFrame& frame) override;
    bool keep(recording::FrameFacts&, const RawImage&) override { return true; }
    void check_end() const override;

    void check_layout();
    double guessed_rate() const;
    void set_time(const AVFrame& frame, std::uint32_t lost);

    Picture picture_;
    std::uint64_t next_sequence_ = 0;
    std::uint32_t undecodable_ = 0;  ///< packets since the last frame
    std::string undecodable_why_;
    bool cut_packet_ = false;  ///< the one read last is incomplete
    std::optional<std::int64_t> first_pts_;
    std::int64_t last_time_ns_ = 0;
};

}  // namespace disparityd::capture
