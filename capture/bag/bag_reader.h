// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "capture/bag/bag_image.h"
#include "capture/bag/bag_messages.h"
#include "capture/bag/bag_topics.h"
#include "capture/bag/bag_uri.h"
#include "capture/recording/recording_reader.h"
#include "capture/stamp_pairs.h"

namespace disparityd::capture {

/// Reads the pairs of images of a bag as frames.
class BagReader final : public RecordingReader {
public:
    /// Finds topics and calibration, and reads the first pairs. Throws as open_bag(). Without `calibrated` the
    /// calibration in the bag is not looked at. Topics that are `known` are not searched for.
    BagReader(const BagUri& uri, bool calibrated, std::optional<ChosenTopics> known = std::nullopt);

    const ChosenTopics& topics() const { return topics_; }

    const Info& info() const override { return info_; }
    std::size_t frame_bytes() const override;
    bool read(recording::FrameFacts& facts, std::uint8_t* pixels) override;

private:
    using Pair = StampPairs<BagImage>::Pair;

    /// A pair with what came before it.
    struct Frame {
        Pair eyes;
        std::uint32_t lost_before = 0;
        std::vector<SensorSample> sensors;
    };

    void survey(bool calibrated);
    void read_calibration();
    void describe(bool calibrated);
    std::optional<Frame> next_frame();
    std::optional<Pair> next_pair();
    void take_message();
    void take_sample(const formats::RosMessage& message, std::int64_t stamp_ns);
    void put_pixels(const Frame& frame, std::uint8_t* pixels) const;
    void check_size(const cv::Mat& pixels, int width) const;

    const BagUri uri_;
    ChosenTopics topics_;
    Info info_;
    std::optional<BagMessages> bag_;
    StampPairs<BagImage> pairs_;
    std::optional<BagImage> both_;       ///< an image of both eyes that was not returned yet
    std::vector<SensorSample> sensors_;  ///< since the pair before
    std::uint32_t lost_samples_ = 0;     ///< before the first of them
    std::deque<Frame> first_;            ///< what the constructor has read
    std::int64_t start_ns_ = 0;          ///< stamp of the first frame
    std::uint64_t sequence_ = 0;
    bool ended_ = false;
    std::exception_ptr failure_;  ///< why the bag ended early; told when all that is whole was returned
};

}  // namespace disparityd::capture
