// SPDX-License-Identifier: Apache-2.0
//
// A client of the socket whose daemon goes and comes back.
#include <atomic>
#include <stdexcept>
#include <thread>

#include <disparity_client.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/monotonic_clock.h"
#include "tests/proto/fake_daemon.h"

namespace v1 = disparityd::v1;
using disparity::ReadResult;
using namespace std::chrono_literals;

namespace {

constexpr auto long_enough = 60s;

/// One plane of a single pixel.
void send_frame(ServerEnd& end, std::uint64_t index) {
    v1::Envelope envelope;
    envelope.mutable_frame()->set_publish_index(index);
    envelope.mutable_frame()->set_sent_monotonic_ns(disparityd::proto::monotonic_ns());
    v1::PlaneInfo& plane = *envelope.mutable_frame()->add_planes();
    plane.set_product(v1::CONFIDENCE);
    plane.set_width(1);
    plane.set_height(1);
    plane.set_bytes_per_pixel(1);
    plane.set_payload_bytes(1);
    envelope.set_payload_bytes(1);
    const std::uint8_t pixel = 1;
    end.send(envelope, {&pixel, 1});
}

void refuse(ServerEnd& end, const std::string& why) {
    v1::Envelope message;
    end.receive(message);
    message.mutable_error()->set_message(why);
    message.mutable_error()->set_closing(true);
    end.send(message);
}

TEST(ClientReturn, ReadingOnConnectsAgainAndSubscribesAsBefore) {
    std::atomic<std::uint64_t> connections{0};
    FakeDaemon daemon([&](ServerEnd& end) {
        EXPECT_EQ(end.greet().hello().client_name(), "tester");
        v1::Envelope subscribe;
        end.receive(subscribe);
        EXPECT_EQ(subscribe.subscribe().products_size(), 1);
        EXPECT_EQ(subscribe.subscribe().max_rate(), 12.5);
        send_frame(end, ++connections);
    });
    for (const std::string& address : {daemon.unix_address(), daemon.tcp_address()}) {
        connections = 0;
        disparity::SocketClient client(address, "tester");
        disparity::Subscription subscription;
        subscription.max_rate = 12.5;
        client.subscribe(subscription);
        disparity::Frame frame;
        for (std::uint64_t index = 1; index <= 3; ++index) {
            ASSERT_EQ(client.read(frame, long_enough), ReadResult::frame);
            EXPECT_EQ(frame.publish_index, index);
            ASSERT_EQ(client.read(frame, long_enough), ReadResult::gone) << "each end is told once";
            EXPECT_EQ(client.why_gone(), "disparityd at " + address + ": the connection has ended");
        }
        v1::Welcome welcome;
        ASSERT_TRUE(welcome.ParseFromString(client.welcome()));
        EXPECT_EQ(welcome.server_version(), "fake");
    }
}

TEST(ClientReturn, TheFirstGoneComesAtOnceTheNextOnesAfterTheTimeout) {
    std::unique_ptr<disparity::SocketClient> client;
    std::string address;
    {
        FakeDaemon daemon([](ServerEnd& end) { end.greet(); });
        address = daemon.unix_address();
        client = std::make_unique<disparity::SocketClient>(address);
    }
    disparity::Frame frame;
    EXPECT_EQ(client->read(frame, long_enough), ReadResult::gone);
    for (int i = 0; i < 3; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        EXPECT_EQ(client->read(frame, 80ms), ReadResult::gone);
        EXPECT_GE(std::chrono::steady_clock::now() - begin, 79ms);
        EXPECT_THAT(client->why_gone(), testing::HasSubstr(address + ": cannot connect"));
    }
    client->subscribe({});  // counts later
    EXPECT_THROW(client->status(1ms), std::runtime_error);
}

TEST(ClientReturn, QuestionsConnectAgainToo) {
    FakeDaemon daemon([](ServerEnd& end) {
        end.greet();
        v1::Envelope request;
        while (end.receive(request) && !request.has_status_request()) {
        }
        v1::Envelope answer;
        answer.mutable_status()->set_state("running");
        end.send(answer);
    });
    disparity::SocketClient client(daemon.unix_address());
    for (int i = 0; i < 3; ++i) {
        v1::Status status;
        ASSERT_TRUE(status.ParseFromString(client.status(long_enough)));
        EXPECT_EQ(status.state(), "running");
        disparity::Frame frame;
        EXPECT_EQ(client.read(frame, long_enough), ReadResult::gone);
    }
}

// A daemon closes a connection on which nothing was asked for long, and says so first.
TEST(ClientReturn, AQuestionAfterALongSilenceIsAnswered) {
    std::atomic<bool> told{false};
    FakeDaemon daemon([&](ServerEnd& end) {
        end.greet();
        if (!told) {
            v1::Envelope farewell;
            farewell.mutable_error()->set_message("nothing was asked for 60 s");
            farewell.mutable_error()->set_closing(true);
            end.send(farewell);
            told = true;
            return;
        }
        v1::Envelope request;
        end.receive(request);
        v1::Envelope answer;
        answer.mutable_status()->set_state("running");
        end.send(answer);
    });
    disparity::SocketClient client(daemon.unix_address());
    while (!told) {
        std::this_thread::yield();
    }
    v1::Status status;
    ASSERT_TRUE(status.ParseFromString(client.status(long_enough)));
    EXPECT_EQ(status.state(), "running");
}

// A place that somebody else's lost connection still takes is free a moment later.
TEST(ClientReturn, ARefusalIsToldOnlyWhenItLastsUntilTheTimeout) {
    std::atomic<int> connections{0};
    std::atomic<bool> full{false};
    FakeDaemon daemon([&](ServerEnd& end) {
        if (full || ++connections == 2) {
            refuse(end, "the daemon serves 64 clients already");
            return;
        }
        end.greet();
        send_frame(end, static_cast<std::uint64_t>(connections));
    });
    disparity::SocketClient client(daemon.unix_address());
    disparity::Frame frame;
    ASSERT_EQ(client.read(frame, long_enough), ReadResult::frame);
    ASSERT_EQ(client.read(frame, long_enough), ReadResult::gone);
    ASSERT_EQ(client.read(frame, long_enough), ReadResult::frame);
    EXPECT_EQ(frame.publish_index, 3U);
    ASSERT_EQ(client.read(frame, long_enough), ReadResult::gone);
    full = true;
    for (const auto timeout : {2000ms, 1990ms, 1950ms}) {  // wherever in its attempts the time is up
        try {
            client.read(frame, timeout);
            ADD_FAILURE() << "nothing thrown";
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(),
                         ("disparityd at " + daemon.unix_address() + ": the daemon serves 64 clients already").c_str());
        }
    }
    full = false;
    EXPECT_EQ(client.read(frame, long_enough), ReadResult::frame) << "reading on is allowed";
}

// A program with a loop of its own looks for frames without waiting.
TEST(ClientReturn, AGreetingThatComesLateSurvivesShortTimeouts) {
    std::atomic<bool> first{true};
    std::atomic<bool> asked{false};
    FakeDaemon daemon([&](ServerEnd& end) {
        if (first.exchange(false)) {
            end.greet();
            return;
        }
        while (!asked) {
            std::this_thread::yield();
        }
        end.greet();
        send_frame(end, 7);
        v1::Envelope envelope;
        while (end.receive(envelope)) {
        }
    });
    disparity::SocketClient client(daemon.unix_address());
    disparity::Frame frame;
    ASSERT_EQ(client.read(frame, long_enough), ReadResult::gone);
    for (int i = 0; i < 5; ++i) {
        ASSERT_EQ(client.read(frame, 0ms), ReadResult::gone);
    }
    asked = true;
    ReadResult result = ReadResult::gone;
    const auto deadline = std::chrono::steady_clock::now() + long_enough;
    while (result != ReadResult::frame && std::chrono::steady_clock::now() < deadline) {
        result = client.read(frame, 0ms);
    }
    EXPECT_EQ(result, ReadResult::frame);
    EXPECT_EQ(frame.publish_index, 7U);
}

// As over a link that was cut: TCP would tell it after a quarter of an hour.
TEST(ClientReturn, ADaemonThatSaysNothingIsAskedAndLeft) {
    std::atomic<std::uint64_t> connections{0};
    std::atomic<bool> asked{false};
    FakeDaemon daemon([&](ServerEnd& end) {
        const bool silent = ++connections == 1;
        EXPECT_NE(end.greet_with_clock().hello().client_id(), 0U);
        v1::Envelope message;
        while (end.receive(message)) {
            if (silent) {
                asked = asked || message.has_ping();
            } else if (message.has_ready()) {
                send_frame(end, 5);
            }
        }
    });
    disparity::SocketClient client(daemon.tcp_address());
    client.subscribe({});
    disparity::Frame frame;
    ASSERT_EQ(client.read(frame, long_enough), ReadResult::gone);
    EXPECT_THAT(client.why_gone(), testing::MatchesRegex("disparityd at tcp:.*: no answer from the daemon for .* s: "
                                                         "connecting anew"));
    EXPECT_TRUE(asked);
    ASSERT_EQ(client.read(frame, long_enough), ReadResult::frame);
    EXPECT_EQ(frame.publish_index, 5U);
}

TEST(ClientReturn, AFrameBeforeTheEndIsGiven) {
    std::atomic<int> sent{0};
    FakeDaemon daemon([&](ServerEnd& end) {
        end.greet_with_clock();
        v1::Envelope message;
        while (sent < 2 && end.receive(message)) {
            if (message.has_ready()) {
                send_frame(end, static_cast<std::uint64_t>(++sent));
            }
        }
        end.close();
        ++sent;
        while (end.receive(message)) {
        }
    });
    disparity::SocketClient client(daemon.unix_address());
    client.subscribe({});
    disparity::Frame frame;
    ASSERT_EQ(client.read(frame, long_enough), ReadResult::frame);
    while (sent < 3) {
        std::this_thread::yield();
    }
    ASSERT_EQ(client.read(frame, long_enough), ReadResult::frame);
    EXPECT_EQ(frame.publish_index, 2U);
    EXPECT_EQ(client.read(frame, long_enough), ReadResult::gone);
}

// A source that has ended, or a camera that was unplugged.
TEST(ClientReturn, ADaemonThatAnswersIsNotLeft) {
    std::atomic<int> answers{0};
    FakeDaemon daemon([&](ServerEnd& end) {
        end.greet_with_clock();
        v1::Envelope message;
        while (end.receive(message)) {
            if (message.has_ping()) {
                v1::Envelope answer;
                answer.mutable_pong()->set_client_ns(message.ping().client_ns());
                answer.mutable_pong()->set_monotonic_ns(disparityd::proto::monotonic_ns());
                end.send(answer);
                ++answers;
            }
        }
    });
    disparity::SocketClient client(daemon.unix_address());
    client.subscribe({});
    disparity::Frame frame;
    while (answers < 4) {
        ASSERT_EQ(client.read(frame, 20ms), ReadResult::timeout);
    }
}

void answer_status(ServerEnd& end) {
    v1::Envelope answer;
    answer.mutable_status()->set_state("running");
    end.send(answer);
}

/// Frames that nobody can be too slow for, however busy the machine is.
disparity::Subscription rare_frames() {
    disparity::Subscription subscription;
    subscription.max_rate = 0.01;
    return subscription;
}

// An order that is sent while a frame is given makes that frame late.
TEST(ClientReturn, AProgramThatKeepsUpOrdersAFrameWhenItWaits) {
    std::string heard;
    {
        FakeDaemon daemon([&](ServerEnd& end) {
            end.greet_with_clock();
            std::uint64_t sent = 0;
            v1::Envelope message;
            while (end.receive(message)) {
                if (message.has_ready()) {
                    heard += "ready " + std::to_string(message.ready().frames()) + ", ";
                    send_frame(end, sent++);
                } else if (message.has_status_request()) {
                    heard += "status, ";
                    answer_status(end);
                }
            }
        });
        disparity::SocketClient client(daemon.unix_address());
        client.subscribe(rare_frames());
        disparity::Frame frame;
        for (int i = 0; i < 3; ++i) {
            ASSERT_EQ(client.read(frame, long_enough), ReadResult::frame);
            client.status(long_enough);
        }
    }
    EXPECT_EQ(heard, "ready 1, status, ready 1, status, ready 1, status, ");
}

// A program that never waits for a frame orders the next one as it takes one, and what is known of the daemon's clock
// must not grow old.
TEST(ClientReturn, WhereAFrameIsAlwaysThereTheNextIsOrderedAndTheClockAskedFor) {
    std::string heard;
    std::atomic<bool> asked{false};
    {
        FakeDaemon daemon([&](ServerEnd& end) {
            end.greet_with_clock();
            std::uint64_t sent = 0;
            v1::Envelope message;
            while (end.receive(message)) {
                if (message.has_ready()) {
                    heard += heard.size() < 100 ? "ready, " : "";
                } else if (message.has_status_request()) {
                    heard += heard.size() < 100 ? "status, " : "";
                    send_frame(end, sent++);
                    answer_status(end);
                } else if (message.has_ping()) {
                    asked = sent > 0;
                }
            }
        });
        disparity::SocketClient client(daemon.unix_address());
        client.subscribe(rare_frames());
        disparity::Frame frame;
        const auto deadline = std::chrono::steady_clock::now() + long_enough;
        while (!asked && std::chrono::steady_clock::now() < deadline) {
            client.status(long_enough);
            ASSERT_EQ(client.read(frame, long_enough), ReadResult::frame);
        }
    }
    EXPECT_TRUE(asked);
    EXPECT_THAT(heard, testing::StartsWith("status, ready, status, ready, status, ready, "));
}

// What the daemon said before it closed explains more than a broken connection.
TEST(ClientReturn, WordsBeforeTheEndAreHeardByWhoeverSendsFirst) {
    std::atomic<bool> closed{false};
    FakeDaemon daemon([&](ServerEnd& end) {
        end.greet();
        v1::Envelope message;
        message.mutable_error()->set_message("the daemon has had enough");
        message.mutable_error()->set_closing(true);
        end.send(message);
        end.close();
        closed = true;
    });
    disparity::SocketClient client(daemon.unix_address());
    while (!closed) {
        std::this_thread::yield();
    }
    disparity::Frame frame;
    client.subscribe({});
    try {
        client.read(frame, long_enough);
        ADD_FAILURE() << "nothing thrown";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("the daemon has had enough"));
    }
}

}  // namespace
