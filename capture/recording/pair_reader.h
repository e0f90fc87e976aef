// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "capture/recording/recording_reader.h"

namespace disparityd::capture {

/// Reads two videos, or two tracks of one, that show an eye each, as one side by side. Pictures belong together whose
/// times are nearer than half a period. One without a partner is a lost frame.
class PairReader final : public RecordingReader {
public:
    /// Each reader gives the pictures of one eye as if they were two halves side by side. `name` is for messages.
    /// Throws std::invalid_argument with one line when the two differ in size or pixels.
    PairReader(std::unique_ptr<RecordingReader> left, std::unique_ptr<RecordingReader> right, std::string name,
               std::vector<std::string> notices);

    const Info& info() const override { return info_; }
    std::size_t frame_bytes() const override { return 2 * left_.pixels.size(); }
    bool read(recording::FrameFacts& facts, std::uint8_t* pixels) override;

private:
    struct OneEye {
        std::unique_ptr<RecordingReader> reader;
        recording::FrameFacts facts;
        std::vector<std::uint8_t> pixels;
        bool next() { return reader->read(facts, pixels.data()); }
    };

    bool find_pair(std::uint32_t& lost);
    void check_rest(OneEye& longer) const;

    std::string name_;
    OneEye left_;
    OneEye right_;
    Info info_;
    std::int64_t half_period_ns_ = 0;  ///< 0 = unknown: pictures are paired by their order
    std::uint64_t next_sequence_ = 0;
    std::uint64_t pairs_ = 0;
};

}  // namespace disparityd::capture
