// SPDX-License-Identifier: Apache-2.0
#include "daemon/memory_bounds.h"

#include <gmock/gmock.h>

namespace disparityd::daemon {
namespace {

using testing::HasSubstr;
using testing::Not;

MemoryBounds bounds_of(const Config& config) {
    StreamLayout layout;
    layout.geometry.width = 640;
    layout.geometry.height = 480;
    layout.products = {v1::DISPARITY, v1::CONFIDENCE};
    capture::SourceInfo source;
    source.eye_width = 640;
    source.height = 480;
    return serving_memory(config, layout, source);
}

TEST(MemoryBounds, EachClientTakesItsPart) {
    Config config;
    config.socket.max_clients = 10;
    const MemoryBounds ten = bounds_of(config);
    config.socket.max_clients = 20;
    const MemoryBounds twenty = bounds_of(config);
    EXPECT_EQ(ten.places, 26U) << "16 may be on their way out";
    EXPECT_EQ(twenty.frames, ten.frames);
    const std::size_t frame = 640 * 480 * 3;
    EXPECT_GT(twenty.clients - ten.clients, 10 * 2 * frame) << "one that is sent, one compressed behind it";
    EXPECT_LT(twenty.clients - ten.clients, 10 * (2 * frame + 2'000'000));
    EXPECT_EQ(twenty.system / 36, ten.system / 26);
}

TEST(MemoryBounds, WhatIsOffTakesNothing) {
    Config config;
    config.shared_memory.enabled = false;
    config.socket.tcp.clear();
    config.socket.unix_path.clear();
    config.record.enabled = false;
    EXPECT_EQ(bounds_of(config).all(), 0U);
    EXPECT_THAT(bounds_of(config).text(), Not(HasSubstr("client")));
}

TEST(MemoryBounds, ALineSaysWhatEachPartTakes) {
    const MemoryBounds bounds{200'000'000, 20'000'000, 99'000'001, 10'000'000, 5'000'000, 26, 16};
    EXPECT_EQ(bounds.text(),
              "memory at most: 335 MB: matching 200 MB, frames 20 MB, 26 clients that read nothing 100 MB and their "
              "sockets 10 MB, a recording 5 MB");
}

TEST(MemoryBounds, AWarningNamesTheClientsForWhichThereIsRoom) {
    const MemoryBounds bounds{200'000'000, 20'000'000, 360'000'000, 40'000'000, 5'000'000, 40, 16};
    EXPECT_EQ(bounds.warning({425'000'000, "this machine"}), "") << "the engine has its part";
    EXPECT_EQ(
        bounds.warning({425'000'000 - 1, "this machine"}),
        "this machine has 425 MB left, and this configuration may take 425 MB more: with [socket] max_clients = 23 "
        "it would not");
    EXPECT_THAT(bounds.warning({100'000'000, "control group /a"}), HasSubstr("choose fewer slots, fewer clients"));
    EXPECT_EQ(bounds.warning({}), "") << "nothing is known about the machine";
}

}  // namespace
}  // namespace disparityd::daemon
