// SPDX-License-Identifier: Apache-2.0
//
// One frame, published over shared memory and over sockets, read by C++, C and Python: the same bytes and numbers.
#include <cinttypes>
#include <concepts>
#include <cstdio>
#include <map>
#include <optional>
#include <span>
#include <sstream>

#include <disparity_client.h>
#include <disparity_client.hpp>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zstd.h>

#include "proto/frame_message.h"
#include "tests/proto/command_output.h"
#include "tests/proto/fake_daemon.h"
#include "tests/proto/pattern.h"
#include "tests/proto/sensor_pattern.h"
#include "tests/temporary_folder.h"

namespace proto = disparityd::proto;
namespace v1 = disparityd::v1;
using namespace std::chrono_literals;

namespace {

constexpr std::uint64_t sequence = 123456789;

template <typename Bytes>
std::uint64_t fnv1a(const Bytes& bytes) {
    std::uint64_t hash = 0xcbf29ce484222325ULL;
    for (const auto byte : bytes) {
        hash = (hash ^ static_cast<std::uint8_t>(byte)) * 0x100000001b3ULL;
    }
    return hash;
}

std::string in_text(double value) {
    char text[40];
    std::snprintf(text, sizeof text, " %.17g", value);
    return text;
}

template <std::integral T>
std::string in_text(T value) {
    return " " + std::to_string(value);
}

/// The digest of floats, 0 where there are none.
std::uint64_t digest(const std::optional<disparity::FloatImage>& image) {
    return image ? fnv1a(std::as_bytes(std::span(image->values))) : 0;
}

/// What is computed from the planes, to the last bit.
template <typename AnyFrame>
std::string describe_metres(const char* way, const AnyFrame& f) {
    std::vector<float> places;
    std::vector<std::uint8_t> colours;
    for (const std::uint32_t step : {1U, 3U}) {
        const disparity::Points points = f.points(step).value();
        for (const disparity::Point& point : points.points) {
            places.insert(places.end(), {point.x, point.y, point.z});
            colours.insert(colours.end(), {point.red, point.green, point.blue});
        }
    }
    char line[200];
    std::snprintf(line, sizeof line,
                  "%s metres %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 "\n", way,
                  digest(f.disparity_px()), digest(f.depth_m()), digest(f.depth_error_m()),
                  fnv1a(std::as_bytes(std::span(places))), fnv1a(colours));
    return line;
}

/// Of a frame that was copied or borrowed.
template <typename AnyFrame>
std::string describe(const char* way, const AnyFrame& f) {
    std::string text = way;
#define ADD_FIELD(name) text += in_text(f.name);
    DISPARITYD_FRAME_FIELDS(ADD_FIELD, ADD_FIELD)
#undef ADD_FIELD
    text += in_text(f.region_x) + in_text(f.region_y) + "\n";
    char line[700];
    for (const auto& plane : f.planes) {
        std::snprintf(line, sizeof line, "%s plane %u %u %u %u %016" PRIx64 "\n", way,
                      static_cast<unsigned>(plane.product), plane.width, plane.height, plane.bytes_per_pixel,
                      fnv1a(plane.bytes));
        text += line;
    }
    return text + describe_metres(way, f);
}

/// Returns the lines without their ages: each reader counts until its own now.
std::string without_ages(const std::string& text) {
    std::istringstream lines(text);
    std::string out;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string word;
        for (int i = 0; words >> word; ++i) {
            const bool age =
                i == 5 && line.find(" plane ") == std::string::npos && line.find(" metres ") == std::string::npos;
            out += (i == 0 ? "" : " ") + (age ? "-" : word);
        }
        out += "\n";
    }
    return out;
}

class SameFrame : public testing::Test {
protected:
    proto::ShmLayout layout_{321, 123, {{1, 2}, {2, 1}, {5, 3}, {3, 2}, {7, 2}}};
    std::string name_ = pattern::unique_name("same", ::getpid());
    proto::SharedMemoryWriter writer_{name_, layout_};
    FakeDaemon daemon_{[this](ServerEnd& end) { serve(end); }};

    SameFrame() {
        pattern::Source source(layout_);
        writer_.publish(pattern::head(sequence, layout_), source.make(sequence));
        heart_ = std::jthread([this](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                writer_.heartbeat();
                std::this_thread::sleep_for(100ms);
            }
        });
    }

    void serve(ServerEnd& end) {
        end.greet();
        v1::Envelope subscribe;
        end.receive(subscribe);
        EXPECT_EQ(subscribe.subscribe().products_size(), 5);
        if (subscribe.subscribe().sensors()) {
            end.send(sensor_message());
        }
        v1::Envelope envelope;
        v1::Frame& frame = *envelope.mutable_frame();
        proto::fill(frame, pattern::head(sequence, layout_));
        std::vector<std::uint8_t> payload;
        pattern::Source source(layout_);
        for (const proto::PlaneSource& from : source.make(sequence)) {
            v1::PlaneInfo& plane = *frame.add_planes();
            plane.set_product(static_cast<v1::Product>(from.product));
            plane.set_width(layout_.width);
            plane.set_height(layout_.height);
            plane.set_bytes_per_pixel(static_cast<std::uint32_t>(from.row_bytes / layout_.width));
            plane.set_payload_bytes(from.row_bytes * layout_.height);
            std::vector<std::uint8_t> bytes;
            for (std::size_t y = 0; y < layout_.height; ++y) {
                const auto* row = static_cast<const std::uint8_t*>(from.data) + y * from.stride;
                bytes.insert(bytes.end(), row, row + from.row_bytes);
            }
            if (subscribe.subscribe().encoding() == v1::ZSTD) {
                std::vector<std::uint8_t> packed(ZSTD_compressBound(bytes.size()));
                packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 1));
                plane.set_encoding(v1::ZSTD);
                plane.set_payload_bytes(packed.size());
                bytes = packed;
            }
            payload.insert(payload.end(), bytes.begin(), bytes.end());
        }
        envelope.set_payload_bytes(payload.size());
        end.send(envelope, payload);
        v1::Envelope error;
        error.mutable_error()->set_message("the fake daemon has said everything");
        end.send(error);
    }

    /// Publishes as many frames as there are slots.
    void write_over() {
        pattern::Source source(layout_);
        for (std::uint64_t later = 1; later <= 4; ++later) {
            writer_.publish(pattern::head(sequence + later, layout_), source.make(sequence + later));
        }
    }

    /// As the C++ client sees it, over both ways.
    std::string wanted(const std::string& address, bool with_shared_memory = true) {
        disparity::Frame frame;
        disparity::SocketClient client(address);
        disparity::Subscription subscription;
        subscription.products = {disparity::Product::disparity, disparity::Product::confidence,
                                 disparity::Product::left_colour, disparity::Product::depth,
                                 disparity::Product::depth_error};
        client.subscribe(subscription);
        EXPECT_EQ(client.read(frame, 20s), disparity::ReadResult::frame);
        std::string text = describe("socket", frame);
        if (with_shared_memory) {
            disparity::SharedMemoryReader reader(name_);
            EXPECT_EQ(reader.read(frame, 20s), disparity::ReadResult::frame);
            text += describe("shm", frame);
            disparity::SharedMemoryReader another(name_);
            disparity::BorrowedFrame borrowed;
            EXPECT_EQ(another.borrow(borrowed, 20s), disparity::ReadResult::frame);
            text += describe("borrowed", borrowed);
            EXPECT_TRUE(borrowed.whole());
            disparity::Subscription two;
            two.products = {disparity::Product::disparity, disparity::Product::left_colour};
            disparity::Client door = disparity::connect(name_, two);
            EXPECT_EQ(door.read(frame, 20s), disparity::ReadResult::frame);
            text += describe("door", frame);
        }
        return without_ages(text);
    }

private:
    std::jthread heart_;
};

TEST_F(SameFrame, CppReadsTheSameOverBothWays) {
    std::string text = wanted(daemon_.tcp_address());
    // The parts differ in their first word only.
    std::map<std::string, std::string> parts;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        const std::size_t word = line.find(' ');
        parts[line.substr(0, word)] += line.substr(word) + "\n";
    }
    ASSERT_EQ(parts.size(), 4U);
    EXPECT_EQ(parts["socket"], parts["shm"]);
    EXPECT_EQ(parts["borrowed"], parts["shm"]);

    disparity::Frame frame;
    disparity::SharedMemoryReader reader(name_);
    ASSERT_EQ(reader.read(frame, 20s), disparity::ReadResult::frame);
    ASSERT_EQ(frame.planes.size(), 5U);
    for (const disparity::PlaneData& plane : frame.planes) {
        EXPECT_EQ(pattern::check_plane(sequence, static_cast<std::uint32_t>(plane.product), plane.bytes), "");
    }
}

TEST_F(SameFrame, ABorrowedFrameOutlivesItsReader) {
    disparity::BorrowedFrame frame;
    EXPECT_FALSE(frame.whole());
    {
        disparity::SharedMemoryReader reader(name_);
        ASSERT_EQ(reader.borrow(frame, 20s), disparity::ReadResult::frame);
    }
    writer_.close();
    disparity::BorrowedFrame moved = std::move(frame);
    const disparity::BorrowedPlane* plane = moved.plane(disparity::Product::confidence);
    ASSERT_NE(plane, nullptr);
    EXPECT_EQ(pattern::check_plane(sequence, 2, {plane->bytes.begin(), plane->bytes.end()}), "");
    EXPECT_EQ(moved.plane(disparity::Product::left), nullptr);
    EXPECT_TRUE(moved.whole());
}

TEST_F(SameFrame, ABorrowedFrameSaysWhenItWasWrittenOver) {
    disparity::SharedMemoryReader reader(name_);
    disparity::BorrowedFrame frame;
    ASSERT_EQ(reader.borrow(frame, 20s), disparity::ReadResult::frame);
    disparity_shared_memory* c_reader = disparity_shared_memory_open(name_.c_str());
    disparity_frame* c_frame = disparity_frame_new();
    ASSERT_EQ(disparity_shared_memory_borrow(c_reader, c_frame, 20000), DISPARITY_FRAME);
    EXPECT_TRUE(frame.whole());
    EXPECT_EQ(disparity_frame_is_whole(c_frame), 1);
    write_over();
    EXPECT_FALSE(frame.whole());
    EXPECT_EQ(disparity_frame_is_whole(c_frame), 0);

    // What a frame held before it was borrowed into is gone, and the other way round.
    ASSERT_EQ(disparity_shared_memory_read(c_reader, c_frame, 20000, nullptr, 0), DISPARITY_FRAME);
    EXPECT_EQ(disparity_frame_is_whole(c_frame), 1);
    EXPECT_EQ(disparity_shared_memory_borrow(c_reader, c_frame, 0), DISPARITY_TIMEOUT);
    EXPECT_EQ(disparity_shared_memory_read(c_reader, c_frame, 0, nullptr, 0), DISPARITY_TIMEOUT);
    disparity_plane plane;
    EXPECT_EQ(disparity_frame_plane_at(c_frame, 0, &plane), 0);
    disparity_frame_free(c_frame);
    disparity_shared_memory_close(c_reader);
}

TEST_F(SameFrame, CReadsTheSame) {
    for (const std::string& address : {daemon_.unix_address(), daemon_.tcp_address()}) {
        const auto [status, text] = command_output(C_CHECK " " + address + " " + name_);
        EXPECT_EQ(status, 0);
        EXPECT_EQ(without_ages(text), wanted(address));
    }
}

TEST_F(SameFrame, PythonReadsTheSame) {
    const std::string python = PYTHON_CHECK;
    if (python.empty()) {
        GTEST_SKIP() << "no Python for this machine's programs";
    }
    for (const std::string& address : {daemon_.unix_address(), daemon_.tcp_address()}) {
        const auto [status, text] = command_output(python + " " + address + " " + name_);
        if (status == 77) {
            GTEST_SKIP() << "numpy or protobuf is not installed for Python";
        }
        EXPECT_EQ(status, 0);
        EXPECT_EQ(without_ages(text), wanted(address, python.find("DISPARITY_SKIP_LIBRARY") == std::string::npos));
    }
}

TEST_F(SameFrame, PythonSaysWhenABorrowedFrameWasWrittenOver) {
    const std::string python = PYTHON_CHECK;
    if (python.empty() || python.find("DISPARITY_SKIP_LIBRARY") != std::string::npos) {
        GTEST_SKIP() << "no Python that loads the library";
    }
    const disparityd::test::TemporaryFolder folder;
    const std::string borrowed = folder.file("borrowed");
    const std::jthread later([&](const std::stop_token& stop) {
        while (::access(borrowed.c_str(), F_OK) != 0 && !stop.stop_requested()) {
            std::this_thread::sleep_for(5ms);
        }
        write_over();
    });
    const auto [status, text] = command_output(python + " --written-over " + name_ + " " + borrowed);
    if (status == 77) {
        GTEST_SKIP() << "numpy or protobuf is not installed for Python";
    }
    EXPECT_EQ(status, 0) << text;
}

}  // namespace
