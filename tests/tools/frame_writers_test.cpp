// SPDX-License-Identifier: Apache-2.0
//
// Files of several frames are written at once: what is told of them stays in order, and nothing is told behind a
// failure.
#include "tools/ctl/processing/frame_writers.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <latch>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace disparityd::tools {
namespace {

constexpr int width = 7;
constexpr int height = 3;

/// A frame whose disparities are its number; rows have a gap, which is not copied.
class Frame {
public:
    explicit Frame(std::int16_t number) : pixels_(std::size_t{stride} * height, -1) {
        view_.disparity = {pixels_.data(), width, height, stride};
        for (int y = 0; y < height; ++y) {
            std::fill_n(view_.disparity.row(y), width, number);
        }
    }
    const FrameView& view() const { return view_; }

private:
    static constexpr int stride = 16;
    std::vector<std::int16_t> pixels_;
    FrameView view_;
};

/// Returns the number of a copied frame, once all its pixels have it.
int number_of(const FrameCopy& copy) {
    const auto& plane = copy.view().disparity;
    EXPECT_EQ(plane.stride, width);
    EXPECT_FALSE(copy.view().left);
    for (int i = 0; i < width * height; ++i) {
        EXPECT_EQ(plane.data[i], plane.data[0]);
    }
    return plane.data[0];
}

void add(FrameWriters& writers, int number) {
    const Frame frame(static_cast<std::int16_t>(number));  // gone when this returns
    writers.add(frame.view(), nullptr, std::to_string(number), {{"number", number}});
}

TEST(FrameWriters, TellInOrderWhateverIsWrittenFirst) {
    pipeline::WorkerPool pool(3);
    std::latch second_is_written(2);
    std::vector<int> told;
    FrameWriters writers(
        pool,
        [&](const FrameCopy& copy, const std::string& name) {
            const int number = number_of(copy);
            EXPECT_EQ(name, std::to_string(number));
            if (number == 0) {
                second_is_written.arrive_and_wait();  // so the first one is done after the second
            } else if (number == 1) {
                second_is_written.count_down();
            }
            return Json(number * 10);
        },
        [&](const Json& frame, const Json& digests) {
            EXPECT_EQ(digests, frame.at("number").get<int>() * 10);
            told.push_back(frame.at("number").get<int>());
        });
    std::vector<int> all;
    for (int i = 0; i < 50; ++i) {
        add(writers, i);
        all.push_back(i);
    }
    writers.settle();
    EXPECT_EQ(told, all);
    EXPECT_FALSE(writers.any_left());
}

TEST(FrameWriters, NothingIsToldBehindAFailure) {
    pipeline::WorkerPool pool(2);
    std::vector<std::string> told;
    std::atomic<int> written{0};
    FrameWriters writers(
        pool,
        [&](const FrameCopy&, const std::string& name) {
            if (name == "2") {
                throw std::runtime_error("the disk is full");
            }
            ++written;
            return Json();
        },
        [&](const Json& frame, const Json&) { told.push_back(frame.at("number").dump()); });
    std::string error;
    int number = 0;
    try {
        for (; number < 20; ++number) {
            add(writers, number);
        }
    } catch (const std::runtime_error& caught) {
        error = caught.what();
    }
    EXPECT_EQ(error, "the disk is full");
    EXPECT_LE(number, 6);  // two threads: three frames at hand
    EXPECT_EQ(told, (std::vector<std::string>{"0", "1"}));
    EXPECT_TRUE(writers.any_left());
    writers.settle();  // told once
}

TEST(FrameWriters, ListThatRefusesAFrameIsAFailure) {
    pipeline::WorkerPool pool(1);
    FrameWriters writers(
        pool, [](const FrameCopy&, const std::string&) { return Json(); },
        [](const Json&, const Json&) { throw std::runtime_error("no room for the list"); });
    add(writers, 0);
    EXPECT_THROW(writers.settle(), std::runtime_error);
    EXPECT_TRUE(writers.any_left());
}

TEST(FrameWriters, EndWithFramesAtHand) {
    pipeline::WorkerPool pool(2);
    std::atomic<int> written{0};
    {
        FrameWriters writers(
            pool, [&](const FrameCopy&, const std::string&) { return Json(++written); },
            [](const Json&, const Json&) { ADD_FAILURE() << "nobody asked"; });
        add(writers, 0);
    }
    EXPECT_EQ(written, 1);
}

}  // namespace
}  // namespace disparityd::tools
