// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "capture/recording/video_reader.h"

namespace disparityd::capture {

/// Reads a side-by-side video of another program. Its container gives the times. A picture that cannot be decoded is a
/// lost frame, and reading goes on.
class ForeignReader final : public VideoReader {
public:
    /// Throws as open_recording_reader().
    explicit ForeignReader(RecordingInput input);

private:
    bool accept(const AVPacket& packet) override;
    void refused(int error) override;
    recording::FrameFacts take_facts(const AVFrame& frame) override;
    void check_end() const override;

    double guessed_rate() const;
    void set_time(const AVFrame& frame);

    std::uint64_t next_sequence_ = 0;
    std::uint32_t undecodable_ = 0;  ///< packets since the last frame
    std::string undecodable_why_;
    bool cut_packet_ = false;  ///< the one read last is incomplete
    std::optional<std::int64_t> first_pts_;
    std::int64_t last_time_ns_ = 0;
};

}  // namespace disparityd::capture
