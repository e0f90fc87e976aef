// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/link.h"

#include <algorithm>
#include <filesystem>

#include <gmock/gmock.h>

#include "tests/bridges/terminal_pair.h"
#include "tests/bridges/udp_listener.h"
#include "tests/temporary_folder.h"

namespace disparityd::mavlink {
namespace {

using test::TerminalPair;
using test::UdpListener;
using testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;
using Clock = Link::Clock;

constexpr std::chrono::seconds link_patience{60};

/// What a terminal would change or act upon if it were not raw: line ends, flow control, interrupt, end of file.
const Bytes awkward{0xfd, 0x0a, 0x0d, 0x11, 0x13, 0x03, 0x04, 0x00, 0xff, 0x7f, 0x1a, 0x80};

Bytes read(TerminalPair& terminal, std::size_t size) {
    Bytes bytes;
    while (bytes.size() < size && terminal.read(bytes)) {
    }
    return bytes;
}

TEST(UdpLink, SendsAMessageAsOneDatagram) {
    UdpListener listener;
    const auto link = udp_link("127.0.0.1", listener.port());
    EXPECT_EQ(link->name(), "udp " + listener.address());
    ASSERT_TRUE(link->send(awkward, Clock::now() + link_patience)) << link->problem();
    EXPECT_EQ(listener.receive(), awkward);
    EXPECT_EQ(link->problem(), "");
    EXPECT_EQ(link->time_for(1000).count(), 0);
}

TEST(UdpLink, TakesNames) {
    UdpListener listener;
    const auto link = udp_link("localhost", listener.port());
    if (link->open()) {  // ::1 where that comes first: then nobody listens
        link->send(awkward, Clock::now() + link_patience);
    }
    EXPECT_THAT(link->problem(), testing::AnyOf("", HasSubstr("udp localhost:")));
}

TEST(UdpLink, GoesOnWhenNobodyListensYet) {
    const std::uint16_t port = UdpListener().port();
    const auto link = udp_link("127.0.0.1", port);
    for (int i = 0; i < 100; ++i) {
        link->send(awkward, Clock::now() + link_patience);
        ASSERT_TRUE(link->open());
    }
    EXPECT_THAT(link->problem(), HasSubstr("nobody listens there; start what listens"));
    UdpListener listener(port);
    ASSERT_TRUE(link->send(awkward, Clock::now() + link_patience));
    EXPECT_EQ(listener.receive(), awkward);
    ASSERT_TRUE(link->send(awkward, Clock::now() + link_patience));
    EXPECT_EQ(link->problem(), "");
}

TEST(UdpLink, SaysThatANameIsNotKnownAndDoesNotAskAgainAtOnce) {
    const auto link = udp_link("no-such-host.invalid", 14550);
    EXPECT_FALSE(link->open());
    EXPECT_THAT(link->problem(), HasSubstr("udp no-such-host.invalid:14550: "));
    const auto before = Clock::now();
    for (int i = 0; i < 1000; ++i) {
        EXPECT_FALSE(link->send(awkward, before));
    }
}

TEST(UdpLink, ThrowsAwayWhatComes) {
    UdpListener listener;
    const auto link = udp_link("127.0.0.1", listener.port());
    ASSERT_TRUE(link->send(awkward, Clock::now() + link_patience));
    ASSERT_TRUE(listener.receive());
    for (int i = 0; i < 100; ++i) {
        listener.answer(Bytes(1000, 0xfd));
        listener.answer({});
        link->drain();
    }
    EXPECT_TRUE(link->send(awkward, Clock::now() + link_patience));
    EXPECT_EQ(listener.receive(), awkward);
    EXPECT_EQ(link->problem(), "");
}

TEST(SerialLink, SendsBytesAsTheyAre) {
    TerminalPair terminal;
    const auto link = serial_link(terminal.path(), 57600);
    ASSERT_TRUE(link->send(awkward, Clock::now() + link_patience)) << link->problem();
    EXPECT_EQ(read(terminal, awkward.size()), awkward);
    EXPECT_EQ(link->problem(), "");
    EXPECT_EQ(link->name(), "serial " + terminal.path() + ":57600");
}

TEST(SerialLink, KnowsHowLongBytesNeed) {
    TerminalPair terminal;
    const auto link = serial_link(terminal.path(), 9600);
    ASSERT_TRUE(link->open()) << link->problem();
    EXPECT_EQ(link->time_for(96), std::chrono::milliseconds(100));  // ten bits for each
}

TEST(SerialLink, DropsAMessageThatFindsNoRoomInTime) {
    TerminalPair terminal;
    const auto link = serial_link(terminal.path(), 115200);
    EXPECT_FALSE(link->send(Bytes(1 << 20, 1), Clock::now() + std::chrono::milliseconds(20)));
    EXPECT_THAT(link->problem(), HasSubstr("no room for a message in time"));
    EXPECT_TRUE(link->open());
    Bytes bytes;
    while (terminal.read(bytes, std::chrono::milliseconds(0))) {
    }
    EXPECT_LE(bytes.size(), 8192U) << "what waited was thrown away, but for what the reader's end (4096) holds already";
    ASSERT_TRUE(link->send(awkward, Clock::now() + link_patience));
    EXPECT_EQ(link->problem(), "");
}

TEST(SerialLink, ThrowsAwayWhatNobodyHasReadInTime) {
    TerminalPair terminal;
    const auto link = serial_link(terminal.path(), 921600);
    // The reader's end takes 4095 bytes into its own hands, where nobody but the reader gets at them.
    ASSERT_TRUE(link->send(Bytes(4095, 1), Clock::now() + link_patience)) << link->problem();
    ASSERT_TRUE(link->send(Bytes(2000, 2), Clock::now() + link_patience)) << link->problem();
    const auto deadline = Clock::now() + link_patience;
    while (!link->forget_old() && Clock::now() < deadline) {
    }
    ASSERT_TRUE(link->send(awkward, Clock::now() + link_patience)) << link->problem();
    Bytes bytes;
    const auto has_come = [&bytes] {
        return bytes.size() >= awkward.size() && std::equal(awkward.rbegin(), awkward.rend(), bytes.rbegin());
    };
    while (!has_come() && terminal.read(bytes)) {
    }
    EXPECT_TRUE(has_come());
    EXPECT_EQ(std::count(bytes.begin(), bytes.end(), 2), 0) << "what waited in the line is old";
}

TEST(SerialLink, ThrowsAwayNothingThatMayBeOnItsWay) {
    TerminalPair terminal;
    const auto link = serial_link(terminal.path(), 9600);
    const Bytes eight_seconds(8000, 1);
    for (int i = 0; i < 5; ++i) {
        ASSERT_TRUE(link->send(eight_seconds, Clock::now() + link_patience)) << link->problem();
        EXPECT_FALSE(link->forget_old());
        EXPECT_EQ(read(terminal, eight_seconds.size()), eight_seconds);
    }
}

TEST(SerialLink, ThrowsAwayWhatComes) {
    TerminalPair terminal;
    const auto link = serial_link(terminal.path(), 115200);
    ASSERT_TRUE(link->open());
    for (int i = 0; i < 20; ++i) {
        EXPECT_GT(terminal.fill(), 0U);
        link->drain();
        ASSERT_TRUE(terminal.has_room());
    }
    EXPECT_TRUE(link->open()) << link->problem();
}

TEST(SerialLink, SaysWhatTheSystemSays) {
    const auto absent = serial_link("/dev/no-such-device", 57600);
    EXPECT_FALSE(absent->open());
    EXPECT_THAT(absent->problem(),
                HasSubstr("serial /dev/no-such-device:57600: No such file or directory; plug it in"));
    const auto no_terminal = serial_link("/dev/null", 57600);
    EXPECT_FALSE(no_terminal->open());
    EXPECT_THAT(no_terminal->problem(), HasSubstr("serial /dev/null:57600: "));
}

TEST(SerialLink, ComesBackWhenTheDeviceIsPluggedInAgain) {
    const test::TemporaryFolder folder;
    const std::string device = folder.file("tty");
    auto terminal = std::make_unique<TerminalPair>();
    std::filesystem::create_symlink(terminal->path(), device);
    const auto link = serial_link(device, 57600);
    ASSERT_TRUE(link->send(awkward, Clock::now() + link_patience));
    terminal.reset();
    link->drain();
    EXPECT_FALSE(link->send(awkward, Clock::now() + link_patience));
    EXPECT_THAT(link->problem(), HasSubstr("serial " + device));

    std::filesystem::remove(device);
    TerminalPair another;
    std::filesystem::create_symlink(another.path(), device);
    const auto deadline = Clock::now() + link_patience;
    while (!link->send(awkward, Clock::now()) && Clock::now() < deadline) {
    }
    EXPECT_EQ(link->problem(), "");
    EXPECT_EQ(read(another, awkward.size()), awkward);
}

}  // namespace
}  // namespace disparityd::mavlink
