// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/frame_source.h"
#include "capture/recording/recording_reader.h"
#include "capture/svo/svo_format.h"
#include "capture/svo/svo_picture.h"
#include "capture/svo/svo_video.h"
#include "formats/mcap_reader.h"

namespace disparityd::capture {

/// Reads the video of an SVO2 file as frames.
class SvoReader final : public RecordingReader {
public:
    /// Reads up to the second frame. Throws as open_svo().
    explicit SvoReader(const SourceOptions& options);

    const Info& info() const override { return info_; }
    std::size_t frame_bytes() const override;
    bool read(recording::FrameFacts& facts, std::uint8_t* pixels) override;

private:
    /// What came with a picture.
    struct Message {
        std::int64_t stamp_ns = 0;
        std::int32_t index = -1;  ///< the file's number of the frame; negative: none
        std::vector<SensorSample> sensors;
    };
    struct Frame {
        Message message;
        SvoPicture picture;
        std::uint32_t left_out = 0;  ///< messages between the frame before and this that gave no picture
    };

    void read_until(std::size_t frames);
    void take_message();
    void take_header(std::span<const std::uint8_t> data);
    void take_video(const formats::McapMessage& message);
    void take_payload(std::span<const std::uint8_t> payload, std::optional<SvoSize> size);
    void take_units(std::span<const std::uint8_t> payload);
    void take_sample(const formats::McapMessage& message);
    void receive_pictures();
    void add_frame(std::int64_t number, SvoPicture picture);
    void leave_out(const std::string& why);
    std::int64_t stamp_of(const SvoVideoMessage& video, std::uint64_t log_ns);

    [[noreturn]] void refuse() const;
    void describe();
    void describe_topics();
    void find_calibration();
    void set_facts(Frame& frame, recording::FrameFacts& facts);
    void check_end();

    const SourceOptions options_;
    formats::McapReader file_;
    Info info_;
    SvoHeader header_;
    bool header_told_ = false;           ///< that it is not understood
    std::string camera_;                 ///< the topic of the video
    std::string serial_;                 ///< of the camera; before the first video that of the first sensors
    std::optional<SvoPayload> payload_;  ///< of the first message whose payload is known
    std::optional<AnnexBCodec> codec_;
    std::optional<SvoVideo> video_;
    bool start_needed_ = true;              ///< units are left out until one has the parameters of the video
    std::map<std::int64_t, Message> sent_;  ///< whose pictures the decoder has not given yet, by number
    std::deque<Frame> ready_;
    std::int64_t messages_ = 0;           ///< of video so far
    std::int64_t last_number_ = -1;       ///< of the message of the last frame
    std::uint64_t left_out_ = 0;          ///< messages of video before it that gave no frame
    std::string left_out_why_;            ///< the first of them
    std::vector<SensorSample> sensors_;   ///< since the message of video before
    std::uint32_t lost_samples_ = 0;      ///< before the first of them
    std::uint64_t sensors_left_out_ = 0;  ///< messages of the sensors that gave no sample
    std::string sensors_why_;             ///< of the first of them
    std::optional<bool> by_log_;          ///< the first footer has no time: those of the container are taken
    std::int64_t last_stamp_ns_ = 0;
    std::int64_t start_ns_ = 0;  ///< stamp of the first frame
    std::uint64_t frames_ = 0;   ///< returned
    std::optional<std::int32_t> last_index_;
    std::uint64_t sequence_ = 0;
    bool ended_ = false;
    std::exception_ptr failure_;  ///< why the file ended early; told when all that is whole was returned
};

}  // namespace disparityd::capture
