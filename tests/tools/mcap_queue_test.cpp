// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/recording/mcap_queue.h"

#include <future>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>

namespace disparityd::tools {
namespace {

using testing::ElementsAre;

disparity::Frame frame_of(std::uint64_t sequence) {
    disparity::Frame frame;
    frame.sequence = sequence;
    return frame;
}

/// A disk that holds the first frame until it is let go.
class HeldDisk {
public:
    McapQueue::Takers takers() {
        return {.frame =
                    [this](const disparity::Frame& frame) {
                        if (sequences_.empty()) {
                            holds_.set_value();
                            go_.get_future().wait();
                        }
                        sequences_.push_back(frame.sequence);
                    },
                .sample = [this](const disparity::SensorSample&) { ++samples_; }};
    }
    void wait_until_it_holds() { holds_.get_future().wait(); }
    void let_go() { go_.set_value(); }
    const std::vector<std::uint64_t>& sequences() const { return sequences_; }
    std::size_t samples() const { return samples_; }

private:
    std::promise<void> holds_, go_;
    std::vector<std::uint64_t> sequences_;
    std::size_t samples_ = 0;
};

TEST(McapQueue, ADiskThatWaitsKeepsTheNewestFrames) {
    HeldDisk disk;
    McapQueue queue(disk.takers());
    queue.push(frame_of(0));
    disk.wait_until_it_holds();
    for (std::uint64_t i = 1; i <= 20; ++i) {
        queue.push(frame_of(i));  // never waits, else the test would not end
    }
    queue.push(std::vector<disparity::SensorSample>(McapQueue::most_samples + 5));
    EXPECT_EQ(queue.dropped(), 12U);
    EXPECT_EQ(queue.kept(), 9U);
    EXPECT_EQ(queue.dropped_samples(), 5U);
    disk.let_go();
    queue.finish();
    EXPECT_THAT(disk.sequences(), ElementsAre(0, 13, 14, 15, 16, 17, 18, 19, 20));
    EXPECT_EQ(disk.samples(), McapQueue::most_samples);
}

TEST(McapQueue, TellsWhyWritingEnded) {
    McapQueue queue({.frame = [](const disparity::Frame&) { throw std::runtime_error("full"); }, .sample = {}});
    queue.push(frame_of(0));
    EXPECT_THROW(queue.finish(), std::runtime_error);
    EXPECT_THROW(queue.check(), std::runtime_error);
}

}  // namespace
}  // namespace disparityd::tools
