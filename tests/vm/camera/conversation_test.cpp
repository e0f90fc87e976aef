// SPDX-License-Identifier: Apache-2.0
//
// The camera and a host that the test plays, without a kernel between them.
#include <cerrno>

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include "tests/vm/camera/camera.h"
#include "tests/vm/camera/commands.h"
#include "tests/vm/camera/test_pattern.h"

namespace simulated_camera {
namespace {

struct Completion {
    std::uint32_t command;
    std::uint32_t sequence;
    int status;
    Bytes data;
};

class Conversation : public testing::Test {
protected:
    Conversation() { camera_.plug_in(); }

    void send(const Bytes& bytes) {
        ASSERT_EQ(::send(host_.get(), bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
        camera_.handle_host();
    }

    static void big_endian(Bytes& bytes, std::uint32_t value) {
        for (int shift = 24; shift >= 0; shift -= 8) {
            bytes.push_back(static_cast<std::uint8_t>(value >> shift));
        }
    }

    static Bytes submission(std::uint32_t sequence, bool to_host, std::uint32_t endpoint, std::uint32_t length,
                            const Bytes& setup, const Bytes& data = {}) {
        Bytes bytes;
        for (const std::uint32_t field : {1U, sequence, 0U, to_host ? 1U : 0U, endpoint, 0U, length, 0U, 0U, 0U}) {
            big_endian(bytes, field);
        }
        append(bytes, setup);
        append(bytes, data);
        return bytes;
    }

    // The camera's timer goes on while the answer is waited for.
    Completion receive() {
        pollfd ready[2] = {{host_.get(), POLLIN, 0}, {camera_.timer(), POLLIN, 0}};
        while (::poll(ready, 2, -1) > 0 && ready[0].revents == 0) {
            camera_.handle_timer();
        }
        Bytes header(48);
        EXPECT_EQ(::recv(host_.get(), header.data(), header.size(), MSG_WAITALL), 48);
        Completion completion{get_big_endian(header, 0, 4),
                              get_big_endian(header, 4, 4),
                              static_cast<int>(get_big_endian(header, 20, 4)),
                              {}};
        completion.data.resize(get_big_endian(header, 24, 4));
        if (!completion.data.empty()) {
            const ssize_t got = ::recv(host_.get(), completion.data.data(), completion.data.size(), MSG_WAITALL);
            EXPECT_EQ(got, static_cast<ssize_t>(completion.data.size()));
        }
        return completion;
    }

    void commit_vga() {
        Bytes settings(34, 0);
        settings[2] = 1;
        settings[3] = 4;
        put_little_endian(settings, 4, interval_of_rate(100), 4);
        send(submission(100, false, 0, 34, {0x21, 0x01, 0x00, 0x02, 0x01, 0x00, 34, 0}, settings));
        Bytes header(48);
        ASSERT_EQ(::recv(host_.get(), header.data(), header.size(), MSG_WAITALL), 48);
        ASSERT_EQ(get_big_endian(header, 20, 4), 0U);
    }

    void ask_for_payload() { send(submission(++sequence_, true, 1, 32768, Bytes(8, 0))); }

    struct Received {
        Bytes frame;
        bool error = false;
    };

    Received receive_frame() {
        Received received;
        while (true) {
            ask_for_payload();
            const Completion payload = receive();
            EXPECT_GE(payload.data.size(), 2U);
            received.frame.insert(received.frame.end(), payload.data.begin() + payload.data[0], payload.data.end());
            received.error = received.error || (payload.data[1] & 0x40) != 0;
            if ((payload.data[1] & 0x02) != 0) {
                return received;
            }
        }
    }

    FileDescriptor host_;
    std::uint32_t sequence_ = 1000;
    Camera camera_{CameraOptions(), [this](Link) {
                       int ends[2];
                       EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
                       host_ = FileDescriptor(ends[0]);
                       return FileDescriptor(ends[1]);
                   }};
};

TEST_F(Conversation, TellsWhoItIs) {
    send(submission(7, true, 0, 18, {0x80, 6, 0, 1, 0, 0, 18, 0}));
    const Completion answer = receive();
    EXPECT_EQ(answer.command, 3U);
    EXPECT_EQ(answer.sequence, 7U);
    ASSERT_EQ(answer.data.size(), 18U);
    EXPECT_EQ(get_little_endian(answer.data, 8, 2), 0x2b03U);
    EXPECT_EQ(get_little_endian(answer.data, 10, 2), 0xf582U);
}

TEST_F(Conversation, StallsWhatItDoesNotKnow) {
    send(submission(8, true, 0, 18, {0x80, 6, 0, 0x77, 0, 0, 18, 0}));
    EXPECT_EQ(receive().status, -EPIPE);
}

TEST_F(Conversation, FramesAreThePattern) {
    commit_vga();
    std::uint32_t last = 0;
    for (int i = 0; i < 3; ++i) {
        const Received received = receive_frame();
        ASSERT_EQ(received.frame.size(), 2U * 1344 * 376);
        EXPECT_EQ(first_difference_from_pattern(received.frame), -1);
        EXPECT_FALSE(received.error);
        EXPECT_GT(pattern_number(received.frame), last);
        last = pattern_number(received.frame);
    }
}

TEST_F(Conversation, FaultsHappenOnceAndAreOver) {
    commit_vga();
    EXPECT_EQ(carry_out(camera_, "err 1"), "ok");
    EXPECT_TRUE(receive_frame().error);
    EXPECT_EQ(carry_out(camera_, "short 1"), "ok");
    EXPECT_EQ(receive_frame().frame.size(), 1344U * 376);
    EXPECT_EQ(carry_out(camera_, "stall 1"), "ok");
    ask_for_payload();
    EXPECT_EQ(receive().status, -EPIPE);
    const Received whole = receive_frame();
    EXPECT_EQ(first_difference_from_pattern(whole.frame), -1);
    EXPECT_EQ(whole.frame.size(), 2U * 1344 * 376);
}

TEST_F(Conversation, AFreezeUntilTheStreamStartsAgainHoldsTransfersBack) {
    commit_vga();
    receive_frame();
    EXPECT_EQ(carry_out(camera_, "freeze restart"), "ok");
    ask_for_payload();
    Bytes withdrawal;
    for (const std::uint32_t field : {2U, 50U, 0U, 1U, 1U, sequence_, 0U, 0U, 0U, 0U, 0U, 0U}) {
        big_endian(withdrawal, field);
    }
    send(withdrawal);
    const Completion withdrawn = receive();
    EXPECT_EQ(withdrawn.command, 4U);
    EXPECT_EQ(withdrawn.status, -ECONNRESET);
    commit_vga();
    EXPECT_EQ(first_difference_from_pattern(receive_frame().frame), -1);
}

TEST_F(Conversation, UnplugClosesTheConnectionAndPlugStartsAnother) {
    EXPECT_EQ(carry_out(camera_, "unplug"), "ok");
    char byte = 0;
    EXPECT_EQ(::recv(host_.get(), &byte, 1, 0), 0);
    EXPECT_EQ(carry_out(camera_, "plug zed2i 777"), "ok");
    send(submission(9, true, 0, 18, {0x80, 6, 0, 1, 0, 0, 18, 0}));
    EXPECT_EQ(get_little_endian(receive().data, 10, 2), 0xf880U);
}

}  // namespace
}  // namespace simulated_camera
