// SPDX-License-Identifier: Apache-2.0
//
// Whose turn it is with the compressor, counted in bytes and turns: nothing here depends on how fast anything is.
#include "daemon/socket/frames/frame_compressor.h"

#include <memory>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <gtest/gtest.h>

#include "tests/daemon/socket/pattern_frames.h"

namespace disparityd {
namespace {

constexpr std::uint32_t width = 640;
constexpr std::uint32_t height = 480;
constexpr std::uint64_t whole_frame = std::uint64_t{width} * height;

/// Wants one region of one plane of bytes, and takes note of what it gets. A greedy one asks again at once.
class FakeClient final : public daemon::FrameCompressor::Client, public std::enable_shared_from_this<FakeClient> {
public:
    FakeClient(daemon::FrameCompressor& compressor, daemon::FrameHandle frame, daemon::Selection::Region region)
        : compressor_(compressor), frame_(std::move(frame)) {
        selection_.products = {v1::LEFT};
        selection_.region = region;
        selection_.encoding = v1::ZSTD;
    }

    daemon::FrameCompressor::Request next_request() noexcept override { return {frame_, selection_}; }
    bool same_request(const daemon::FrameCompressor::Request& request) const noexcept override {
        return request.selection == selection_;
    }
    void compressed(const daemon::FrameCompressor::Request&,
                    std::shared_ptr<const daemon::EncodedPlanes> planes) noexcept override {
        asked = false;
        ++frames;
        if (greedy) {
            ask();
        }
        bytes += std::uint64_t{planes->planes.at(0).width()} * planes->planes.at(0).height();
    }
    void not_compressed(const std::string&) noexcept override { FAIL(); }

    void ask() {
        if (!asked) {
            asked = true;
            compressor_.ask(shared_from_this());
        }
    }

    bool greedy = false;
    bool asked = false;
    int frames = 0;
    std::uint64_t bytes = 0;

private:
    daemon::FrameCompressor& compressor_;
    daemon::FrameHandle frame_;
    daemon::Selection selection_;
};

class FrameCompressorTest : public testing::Test {
protected:
    std::shared_ptr<FakeClient> client(std::uint32_t rows, std::uint32_t own = 0) {
        clients_.push_back(
            std::make_shared<FakeClient>(compressor_, frame_, daemon::Selection::Region{0, own, width, rows}));
        return clients_.back();
    }

    /// So many frames are compressed for clients.
    void turns(int count, const std::vector<std::shared_ptr<FakeClient>>& greedy = {}) {
        for (const auto& client : greedy) {
            client->greedy = true;
            client->ask();
        }
        for (const int end = served() + count; served() < end && io_.poll_one() > 0;) {
        }
        io_.restart();
    }

    int served() const {
        int frames = 0;
        for (const auto& client : clients_) {
            frames += client->frames;
        }
        return frames;
    }

    boost::asio::io_context io_;
    daemon::FrameCompressor compressor_{io_, io_.get_executor()};

private:
    test::PatternFrames feed_{width, height, {v1::LEFT}};
    daemon::FramePool pool_{feed_.layout(), 1};
    daemon::FrameHandle frame_ = pool_.copy(feed_.next(), ~0U);
    std::vector<std::shared_ptr<FakeClient>> clients_;
};

TEST_F(FrameCompressorTest, WhoWantMoreThanThereIsGetTheSameNumberOfBytes) {
    std::vector<std::shared_ptr<FakeClient>> all{client(height)};
    for (std::uint32_t i = 0; i < 4; ++i) {
        all.push_back(client(height / 4, i));  // a region of its own each
    }
    turns(400, all);
    for (const auto& one : all) {
        EXPECT_NEAR(static_cast<double>(one->bytes), static_cast<double>(all[0]->bytes), 2.0 * whole_frame);
        EXPECT_GT(one->bytes, 20 * whole_frame);
    }
}

TEST_F(FrameCompressorTest, WhoWantsLittleLosesNothingToThoseWhoWantMuch) {
    const auto modest = client(height / 20);
    std::vector<std::shared_ptr<FakeClient>> greedy;
    for (std::uint32_t i = 0; i < 10; ++i) {
        greedy.push_back(client(height - 20, i));
    }
    turns(20, greedy);
    modest->ask();
    turns(12);  // a new client stands behind those who wait, once
    ASSERT_EQ(modest->frames, 1);
    modest->frames = 0;
    // A frame comes whenever three large ones are compressed: less than a third of what ten ask for.
    for (int frame = 1; frame <= 50; ++frame) {
        modest->ask();
        turns(4);
        ASSERT_EQ(modest->frames, frame) << "it has missed a frame";
    }
}

TEST_F(FrameCompressorTest, WhoConnectsAgainForEachFrameIsNotAlwaysNext) {
    constexpr std::uint32_t attackers = 8;
    const auto steady = client(height);
    steady->greedy = true;
    steady->ask();
    std::vector<std::shared_ptr<FakeClient>> fresh(attackers);
    for (int turn = 0; turn < 200; ++turn) {
        for (std::uint32_t i = 0; i < attackers; ++i) {
            if (!fresh[i] || fresh[i]->frames > 0) {
                fresh[i] = client(height - attackers, i);  // a region of its own
                fresh[i]->ask();
            }
        }
        turns(1);
    }
    EXPECT_GE(steady->frames, 20) << "of 200 turns, a share of nine";
}

TEST_F(FrameCompressorTest, WhoHasWantedNothingHasSavedNoTurns) {
    const auto late = client(height, 0);
    const auto other = client(height - 1, 1);
    turns(100, {other});
    const int before = other->frames;
    turns(20, {late, other});
    EXPECT_GE(other->frames - before, 9);
    EXPECT_GE(late->frames, 9);
}

TEST_F(FrameCompressorTest, WhatSeveralWantIsChargedInPart) {
    const auto one = client(height);
    const auto two = client(height);
    const auto alone = client(height - 1);
    turns(300, {one, two, alone});
    EXPECT_EQ(one->frames, two->frames);
    EXPECT_NEAR(one->frames, 2 * alone->frames, 6) << "half the price: twice as often";
    EXPECT_EQ(one->account().bytes(), two->account().bytes());
    EXPECT_LT(one->account().bytes(), one->bytes * 6 / 10);
}

TEST_F(FrameCompressorTest, WhoHasGoneIsForgotten) {
    auto gone = std::make_shared<FakeClient>(compressor_, nullptr, daemon::Selection::Region{});
    const auto here = client(height);
    compressor_.ask(gone);
    gone.reset();
    turns(3, {here});
    EXPECT_EQ(here->frames, 3);
}

TEST(CompressorAccount, TellsTheShareOfTheLastSeconds) {
    using namespace std::chrono_literals;
    daemon::CompressorAccount account;
    auto now = daemon::CompressorAccount::Clock::now();
    for (int i = 0; i < 50; ++i) {
        now += 100ms;
        account.charge(1000, 25ms, now);
    }
    EXPECT_NEAR(account.share(now), 0.25, 0.03);
    EXPECT_EQ(account.bytes(), 50'000U);
    EXPECT_EQ(account.time(), 50 * 25ms);
    EXPECT_EQ(account.share(now + 10s), 0);
}

}  // namespace
}  // namespace disparityd
