// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <semaphore>
#include <stdexcept>

#include <disparity_client.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include "tests/capture/open_files_limit.h"
#include "tests/proto/fake_daemon.h"

namespace proto = disparityd::proto;
namespace v1 = disparityd::v1;
using disparity::ReadResult;
using namespace std::chrono_literals;

namespace {

constexpr auto socket_patience = 20s;

v1::Envelope frame_message(std::uint64_t index, std::uint32_t width = 4, std::uint32_t height = 3) {
    v1::Envelope envelope;
    v1::Frame& frame = *envelope.mutable_frame();
    frame.set_publish_index(index);
    frame.set_sequence(index + 100);
    v1::PlaneInfo& plane = *frame.add_planes();
    plane.set_product(v1::CONFIDENCE);
    plane.set_width(width);
    plane.set_height(height);
    plane.set_bytes_per_pixel(1);
    plane.set_payload_bytes(std::uint64_t{width} * height);
    envelope.set_payload_bytes(plane.payload_bytes());
    return envelope;
}

std::vector<std::uint8_t> bytes_of(std::size_t count) {
    std::vector<std::uint8_t> bytes(count);
    for (std::size_t i = 0; i < count; ++i) {
        bytes[i] = static_cast<std::uint8_t>(i * 7);
    }
    return bytes;
}

/// Keeps a connection open until the client leaves.
void until_closed(ServerEnd& end) {
    v1::Envelope envelope;
    while (end.receive(envelope)) {
    }
}

template <class Exception = std::runtime_error, class Call>
std::string failure(Call&& call) {
    try {
        call();
    } catch (const Exception& error) {
        return error.what();
    }
    return "nothing thrown";
}

TEST(SocketClient, FramesComeInOrderWithMissedOnesCounted) {
    std::counting_semaphore<> read(0);
    FakeDaemon daemon([&](ServerEnd& end) {
        const v1::Envelope hello = end.greet();
        EXPECT_EQ(hello.hello().client_name(), "tester");
        v1::Envelope subscribe;
        end.receive(subscribe);
        EXPECT_EQ(subscribe.subscribe().products_size(), 2);
        EXPECT_EQ(subscribe.subscribe().region().width(), 4U);
        end.send(frame_message(1), bytes_of(12));
        read.acquire();
        end.send(frame_message(5), bytes_of(12));
    });
    for (const std::string& address : {daemon.unix_address(), daemon.tcp_address()}) {
        disparity::SocketClient client(address, "tester");
        v1::Welcome welcome;
        ASSERT_TRUE(welcome.ParseFromString(client.welcome()));
        EXPECT_EQ(welcome.server_version(), "fake");
        disparity::Subscription subscription;
        subscription.products = {disparity::Product::confidence, disparity::Product::depth};
        subscription.region_width = 4;
        subscription.region_height = 3;
        client.subscribe(subscription);
        disparity::Frame frame;
        ASSERT_EQ(client.read(frame, socket_patience), ReadResult::frame);
        EXPECT_EQ(frame.skipped, 0U);
        EXPECT_EQ(frame.plane(disparity::Product::confidence)->bytes, bytes_of(12));
        EXPECT_EQ(frame.plane(disparity::Product::depth), nullptr);
        read.release();
        ASSERT_EQ(client.read(frame, socket_patience), ReadResult::frame);
        EXPECT_EQ(frame.sequence, 105U);
        EXPECT_EQ(frame.skipped, 3U);
        EXPECT_EQ(client.read(frame, socket_patience), ReadResult::gone);
    }
}

TEST(SocketClient, MessageInPiecesSurvivesTimeouts) {
    // A slow server: it sends a byte after each timeout of the client.
    std::counting_semaphore<> timed_out(0);
    std::atomic<std::size_t> pieces{0};
    FakeDaemon daemon([&](ServerEnd& end) {
        end.greet();
        std::vector<std::uint8_t> bytes;
        proto::encode(frame_message(1), bytes);
        const auto payload = bytes_of(12);
        bytes.insert(bytes.end(), payload.begin(), payload.end());
        pieces = bytes.size();
        for (const std::uint8_t byte : bytes) {
            timed_out.acquire();
            end.send_bytes({&byte, 1});
        }
        until_closed(end);
    });
    disparity::SocketClient client(daemon.unix_address());
    disparity::Frame frame;
    std::size_t timeouts = 0;
    while (client.read(frame, 1ms) == ReadResult::timeout) {
        ++timeouts;
        timed_out.release();
    }
    EXPECT_GE(timeouts, pieces);
    EXPECT_EQ(frame.plane(disparity::Product::confidence)->bytes, bytes_of(12));
}

TEST(SocketClient, ServerThatClosesInTheMiddleOfAFrameIsGone) {
    FakeDaemon daemon([](ServerEnd& end) {
        end.greet();
        end.send(frame_message(1), bytes_of(5));
    });
    disparity::SocketClient client(daemon.unix_address());
    disparity::Frame frame;
    EXPECT_EQ(client.read(frame, socket_patience), ReadResult::gone);
}

TEST(SocketClient, DaemonsErrorIsTheTextOfTheException) {
    FakeDaemon daemon([](ServerEnd& end) {
        end.greet();
        v1::Envelope error;
        error.mutable_error()->set_message("product DEPTH: not made by this configuration");
        end.send(error);
        end.send(frame_message(1), bytes_of(12));
        until_closed(end);
    });
    disparity::SocketClient client(daemon.unix_address());
    disparity::Frame frame;
    EXPECT_EQ(failure([&] { client.read(frame, socket_patience); }),
              "disparityd at " + daemon.unix_address() + ": product DEPTH: not made by this configuration");
    EXPECT_EQ(client.read(frame, socket_patience), ReadResult::frame)
        << "a refused request does not end the connection";
}

TEST(SocketClient, TooManyOpenFilesAreNotTheDaemonsFault) {
    const disparityd::capture::test::OpenFilesLimit none;
    for (const char* address : {"unix:/tmp/any.sock", "tcp:127.0.0.1:9"}) {
        try {
            disparity::SocketClient client(address);
            FAIL() << "connected";
        } catch (const std::runtime_error& error) {
            EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("this program has too many files open"),
                                                     testing::Not(testing::HasSubstr("is disparityd running"))));
        }
    }
}

TEST(SocketClient, RefusalInsteadOfWelcomeIsReported) {
    FakeDaemon daemon([](ServerEnd& end) {
        v1::Envelope message;
        end.receive(message);
        message.mutable_error()->set_message("too many clients");
        message.mutable_error()->set_closing(true);
        end.send(message);
    });
    EXPECT_THAT(failure([&] { disparity::SocketClient client(daemon.tcp_address()); }),
                testing::HasSubstr("too many clients"));
}

TEST(SocketClient, OtherVersionIsRefused) {
    FakeDaemon daemon([](ServerEnd& end) { end.greet(3); });
    EXPECT_THAT(failure([&] { disparity::SocketClient client(daemon.unix_address()); }),
                testing::HasSubstr("version 3 of the protocol, this program version 2"));
}

TEST(SocketClient, SilentServerEndsInATimeout) {
    FakeDaemon daemon(until_closed);
    EXPECT_THAT(failure([&] { disparity::SocketClient client(daemon.unix_address(), "tester", 50ms); }),
                testing::EndsWith("no answer to hello in time: the daemon hangs, or another program listens "
                                  "there"));
}

TEST(SocketClient, HostileFramesAreRefused) {
    const std::vector<std::pair<const char*, std::function<void(v1::Envelope&)>>> cases{
        {"payload_bytes", [](auto& e) { e.set_payload_bytes(1ULL << 40); }},
        {"payload more than planes", [](auto& e) { e.set_payload_bytes(13); }},
        {"plane more than payload", [](auto& e) { e.mutable_frame()->mutable_planes(0)->set_payload_bytes(1000); }},
        {"plane wraps", [](auto& e) { e.mutable_frame()->mutable_planes(0)->set_payload_bytes(~0ULL); }},
        {"width", [](auto& e) { e.mutable_frame()->mutable_planes(0)->set_width(1 << 30); }},
        {"height", [](auto& e) { e.mutable_frame()->mutable_planes(0)->set_height(2); }},
        {"no pixels", [](auto& e) { e.mutable_frame()->mutable_planes(0)->set_height(0); }},
        {"bytes_per_pixel", [](auto& e) { e.mutable_frame()->mutable_planes(0)->set_bytes_per_pixel(9); }},
        {"encoding", [](auto& e) { e.mutable_frame()->mutable_planes(0)->set_encoding(v1::Encoding(7)); }},
        {"zstd garbage", [](auto& e) { e.mutable_frame()->mutable_planes(0)->set_encoding(v1::ZSTD); }},
        {"zstd bomb",
         [](auto& e) {
             for (int i = 0; i < 3; ++i) {
                 auto& plane = i == 0 ? *e.mutable_frame()->mutable_planes(0) : *e.mutable_frame()->add_planes();
                 plane.set_encoding(v1::ZSTD);
                 plane.set_width(16384);
                 plane.set_height(16384);
             }
         }},
    };
    for (const auto& [what, change] : cases) {
        v1::Envelope message = frame_message(1);
        change(message);
        FakeDaemon daemon([&message = message](ServerEnd& end) {
            end.greet();
            end.send(message, bytes_of(12));
            until_closed(end);
        });
        disparity::SocketClient client(daemon.unix_address());
        disparity::Frame frame;
        EXPECT_THAT(failure([&] { client.read(frame, socket_patience); }), testing::HasSubstr("disparityd at unix:"))
            << what;
    }
}

TEST(SocketClient, HugeEnvelopeIsRefusedAndTheConnectionClosed) {
    FakeDaemon daemon([](ServerEnd& end) {
        end.greet();
        const std::uint8_t four_gib[4] = {0xff, 0xff, 0xff, 0xff};
        end.send_bytes(four_gib);
        until_closed(end);
    });
    disparity::SocketClient client(daemon.unix_address());
    disparity::Frame frame;
    EXPECT_THAT(failure([&] { client.read(frame, socket_patience); }),
                testing::HasSubstr("4294967295 bytes announced"));
    EXPECT_EQ(client.read(frame, socket_patience), ReadResult::gone);
}

TEST(SocketClient, CompressedPlanesAreUnpacked) {
    const auto raw = bytes_of(200 * 100);
    FakeDaemon daemon([&](ServerEnd& end) {
        end.greet();
        std::vector<std::uint8_t> packed(ZSTD_compressBound(raw.size()));
        packed.resize(ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), 1));
        v1::Envelope message = frame_message(1, 200, 100);
        message.set_payload_bytes(packed.size());
        message.mutable_frame()->mutable_planes(0)->set_encoding(v1::ZSTD);
        message.mutable_frame()->mutable_planes(0)->set_payload_bytes(packed.size());
        end.send(message, packed);
        // The same data for a plane of another size: refused, not written beyond its end.
        message.mutable_frame()->mutable_planes(0)->set_height(99);
        end.send(message, packed);
        until_closed(end);
    });
    disparity::SocketClient client(daemon.unix_address());
    disparity::Frame frame;
    ASSERT_EQ(client.read(frame, socket_patience), ReadResult::frame);
    EXPECT_EQ(frame.planes.at(0).bytes, raw);
    EXPECT_THAT(failure([&] { client.read(frame, socket_patience); }), testing::HasSubstr("damaged"));
}

TEST(SocketClient, TheNewestFrameBeforeAnAnswerIsKeptForRead) {
    FakeDaemon daemon([](ServerEnd& end) {
        end.greet();
        v1::Envelope request;
        end.receive(request);
        EXPECT_TRUE(request.has_status_request());
        end.send(frame_message(1), bytes_of(12));
        end.send(frame_message(2), bytes_of(12));
        v1::Envelope answer;
        answer.mutable_status()->set_state("running");
        end.send(answer);
        end.send(frame_message(3), bytes_of(12));
        answer.mutable_status()->set_state("pushed");
        end.send(answer);
        end.receive(request);
        EXPECT_EQ(request.record_start().path(), "/tmp/x.mkv");
        answer.mutable_record_status()->set_active(true);
        end.send(answer);
        until_closed(end);
    });
    disparity::SocketClient client(daemon.unix_address());
    v1::Status status;
    ASSERT_TRUE(status.ParseFromString(client.status(socket_patience)));
    EXPECT_EQ(status.state(), "running");
    disparity::Frame frame;
    std::uint64_t least = 2;
    do {
        ASSERT_EQ(client.read(frame, socket_patience), ReadResult::frame);
        EXPECT_GE(frame.publish_index, least++);
    } while (frame.publish_index != 3);
    v1::RecordStatus record;
    ASSERT_TRUE(record.ParseFromString(client.start_recording("/tmp/x.mkv", socket_patience)));
    EXPECT_TRUE(record.active());
    ASSERT_TRUE(status.ParseFromString(client.take_status()));
    EXPECT_EQ(status.state(), "pushed");
    EXPECT_EQ(client.take_status(), "");
}

TEST(SocketClient, PartsOfATraceAreOneMessage) {
    FakeDaemon daemon([](ServerEnd& end) {
        end.greet();
        v1::Envelope request;
        end.receive(request);
        EXPECT_EQ(request.trace_request().seconds(), 0.5);
        v1::Envelope part;
        part.mutable_trace()->add_tracks()->set_name("first");
        end.send(part);
        end.send(frame_message(1), bytes_of(12));
        part.mutable_trace()->mutable_tracks(0)->set_name("second");
        part.mutable_trace()->set_duration_ns(7);
        part.mutable_trace()->set_last(true);
        end.send(part);
        until_closed(end);
    });
    disparity::SocketClient client(daemon.unix_address());
    v1::Trace trace;
    ASSERT_TRUE(trace.ParseFromString(client.trace(0.5, socket_patience)));
    ASSERT_EQ(trace.tracks_size(), 2);
    EXPECT_EQ(trace.tracks(0).name() + trace.tracks(1).name(), "firstsecond");
    EXPECT_EQ(trace.duration_ns(), 7U);
    disparity::Frame frame;
    EXPECT_EQ(client.read(frame, socket_patience), ReadResult::frame) << "a frame that came meanwhile is kept";
}

TEST(SocketClient, GivesLevelsInTheOrderOfTime) {
    FakeDaemon daemon([](ServerEnd& end) {
        end.greet();
        v1::Envelope request;
        end.receive(request);
        ASSERT_EQ(request.give_level().samples_size(), 2);
        EXPECT_EQ(request.give_level().samples(0).ahead(), 0.6);
        EXPECT_EQ(request.give_level().samples(0).left(), 0);
        EXPECT_EQ(request.give_level().samples(0).up(), 0.8);
        EXPECT_EQ(request.give_level().samples(0).age_us(), 20000U);
        EXPECT_EQ(request.give_level().samples(1).left(), -1);
        EXPECT_EQ(request.give_level().samples(1).age_us(), 0U) << "one of the future is one of now";
        v1::Envelope answer;
        answer.mutable_level_status()->set_source("autopilot");
        end.send(answer);
        until_closed(end);
    });
    disparity::SocketClient client(daemon.unix_address());
    v1::LevelStatus level;
    ASSERT_TRUE(level.ParseFromString(client.give_level(
        {{0.6, 0, 0.8, std::chrono::milliseconds(20)}, {0, -1, 0, std::chrono::milliseconds(-5)}}, socket_patience)));
    EXPECT_EQ(level.source(), "autopilot");
}

TEST(SocketClient, AddressesThatAreNoneAreNamed) {
    for (const char* address : {"", "http:x", "tcp:", "tcp:host", "tcp:host:", "tcp:127.0.0.1:65536",
                                "tcp:127.0.0.1:-1", "tcp:127.0.0.1:80x", "unix:"}) {
        EXPECT_THAT(failure<std::invalid_argument>([&] { disparity::SocketClient client(address); }),
                    testing::HasSubstr(address));
    }
    EXPECT_THAT(failure([&] { disparity::SocketClient client("unix:/nonexistent/socket"); }),
                testing::HasSubstr("unix:/nonexistent/socket: cannot connect: No such file or directory"));
}

}  // namespace
