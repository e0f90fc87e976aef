// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "capture/gstreamer/gst_opened.h"
#include "capture/recording/recording_reader.h"

namespace disparityd::capture {

/// Reads the frames of a pipeline that is not live.
class GstReader final : public RecordingReader {
public:
    /// `stop` is shared by all readers of a source.
    GstReader(GstOpened opened, const SourceOptions& options, GstStop stop);

    const Info& info() const override { return info_; }
    std::size_t frame_bytes() const override;
    bool read(recording::FrameFacts& facts, std::uint8_t* pixels) override;
    void interrupt() noexcept override;

private:
    std::optional<GstFrame> next_frame();
    void set_time(const GstFrame& frame, recording::FrameFacts& facts);

    GstOpened opened_;
    const std::chrono::milliseconds longest_wait_;
    const GstStop stop_;
    Info info_;
    GstPicture picture_;
    std::uint64_t sequence_ = 0;
    std::optional<std::int64_t> first_ns_;
    std::int64_t last_ns_ = 0;
};

}  // namespace disparityd::capture
