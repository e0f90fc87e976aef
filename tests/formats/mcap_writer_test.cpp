// SPDX-License-Identifier: Apache-2.0
//
// What is written is read back, also where it was cut off. other_mcap.cjs reads it with another implementation.
#include "formats/mcap_writer.h"

#include <algorithm>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "formats/mcap_file.h"
#include "formats/mcap_reader.h"
#include "tests/formats/refusal.h"
#include "tests/temporary_folder.h"

namespace disparityd::formats {
namespace {

using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::size_t chunk_bytes = 2000;

/// A message as a test has it.
struct Sent {
    std::uint16_t channel;
    std::uint64_t time_ns;
    std::string data;

    bool operator==(const Sent&) const = default;
};

/// Messages of two channels, some of them longer than a chunk, one that is empty, one that is earlier than the others.
std::vector<Sent> some_messages() {
    std::mt19937 random(7);
    std::vector<Sent> messages;
    for (unsigned i = 0; i < 40; ++i) {
        std::string data(i == 3 ? 0 : i % 11 == 10 ? 3 * chunk_bytes : 200 + random() % 300, '\0');
        std::generate(data.begin(), data.end(), [&random] { return static_cast<char>(random() % 5); });
        messages.push_back({static_cast<std::uint16_t>(i % 2), 1000 + 10 * (i == 20 ? 0 : i), std::move(data)});
    }
    return messages;
}

template <typename Writer>
void put(Writer& writer, const Sent& message, std::uint32_t sequence) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(message.data.data());
    writer.write({message.channel, sequence, message.time_ns, message.time_ns, {bytes, message.data.size()}});
}

template <typename Writer>
void define(Writer& writer) {
    writer.add_channel(writer.add_schema("test_msgs/msg/Text", "ros2msg", "string text"), "/text", "cdr");
    writer.add_channel(0, "/bytes", "raw");
}

McapLayout small_chunks() {
    McapLayout layout;
    layout.chunk_bytes = chunk_bytes;
    return layout;
}

/// A file, and where it may end: behind each call of the sink.
struct Written {
    std::string file;
    std::vector<std::size_t> ends;
    std::vector<std::size_t> messages;  ///< that were given to the writer by then
    std::size_t largest = 0;            ///< call of the sink
};

Written written(const std::vector<Sent>& messages, const McapLayout& layout = small_chunks()) {
    Written result;
    std::size_t given = 0;
    McapStreamWriter writer(
        [&](std::string_view bytes) {
            result.file += bytes;
            result.ends.push_back(result.file.size());
            result.messages.push_back(given);
            result.largest = std::max(result.largest, bytes.size());
        },
        layout);
    define(writer);
    for (const Sent& message : messages) {
        ++given;
        put(writer, message, static_cast<std::uint32_t>(given));
    }
    writer.finish();
    EXPECT_EQ(writer.messages(), messages.size());
    EXPECT_EQ(writer.bytes(), result.file.size());
    return result;
}

/// What a reader gets of a file, and how it ends.
struct Read {
    std::vector<Sent> messages;
    std::string problem;
    bool summary = false;
};

Read read_back(const std::string& path) {
    Read read;
    try {
        McapReader reader(path);
        read.summary = reader.has_summary();
        McapMessage message;
        while (reader.next(message)) {
            EXPECT_EQ(message.sequence, read.messages.size() + 1);
            EXPECT_EQ(message.publish_ns, message.log_ns);
            read.messages.push_back(
                {message.channel, message.log_ns, std::string(message.data.begin(), message.data.end())});
        }
        EXPECT_EQ(reader.message_count(0).value_or(0), read.summary ? 20 : 0);
    } catch (const std::exception& error) {
        read.problem = error.what();
    }
    return read;
}

TEST(McapStreamWriter, WhatIsWrittenIsReadBack) {
    const TemporaryFolder folder;
    const std::vector<Sent> messages = some_messages();
    const Read read = read_back(folder.write("a.mcap", written(messages).file));
    EXPECT_EQ(read.messages, messages);
    EXPECT_EQ(read.problem, "");
    EXPECT_TRUE(read.summary);
}

TEST(McapStreamWriter, TheSameMessagesGiveTheSameBytes) {
    EXPECT_EQ(written(some_messages()).file, written(some_messages()).file);
    std::vector<Sent> others = some_messages();
    others.back().data += "x";
    EXPECT_NE(written(some_messages()).file, written(others).file);
}

TEST(McapStreamWriter, HoldsOneChunkOnly) {
    const Written result = written(some_messages());
    EXPECT_GT(result.ends.size(), 8U);
    for (std::size_t i = 1; i < result.ends.size(); ++i) {
        std::size_t held = 0;  // of messages that came since the call before
        for (std::size_t m = result.messages[i - 1]; m + 1 < result.messages[i]; ++m) {
            held += some_messages()[m].data.size();
        }
        EXPECT_LT(held, chunk_bytes) << i;
    }
}

TEST(McapStreamWriter, AChunkEndsWithItsTime) {
    McapLayout layout;
    layout.chunk_ns = 55;
    const auto chunks_of = [](const Written& result) { return result.ends.size() - 3; };
    EXPECT_EQ(chunks_of(written(some_messages(), layout)), 8U);  // 40 messages, 10 ns apart, and one early
    EXPECT_EQ(chunks_of(written(some_messages(), McapLayout())), 1U);
}

/// Each cut leaves the chunks that are whole in front of it.
TEST(McapStreamWriter, AFileThatWasCutOffGivesItsWholeChunks) {
    const TemporaryFolder folder;
    const std::vector<Sent> messages = some_messages();
    const Written result = written(messages);
    const std::size_t data_end = result.ends[result.ends.size() - 2];
    for (std::size_t size = mcap_magic.size(); size < result.file.size(); size += 31) {
        const Read read = read_back(folder.write("cut.mcap", result.file.substr(0, size)));
        std::size_t whole = 0;
        for (std::size_t i = 0; i < result.ends.size() && result.ends[i] <= size; ++i) {
            whole = result.messages[i];
        }
        // The chunk at the cut may be whole, and only its indexes not.
        ASSERT_GE(read.messages.size(), whole) << size;
        ASSERT_TRUE(std::equal(read.messages.begin(), read.messages.end(), messages.begin())) << size;
        if (size < data_end) {
            ASSERT_THAT(read.problem, HasSubstr("cut off")) << size;
        }
    }
}

/// As of a disk that is full.
TEST(McapStreamWriter, CountsWhatTheSinkHasTaken) {
    const std::vector<Sent> messages = some_messages();
    const Written whole = written(messages);
    constexpr std::size_t taken = 5;
    std::size_t calls = 0;
    McapStreamWriter writer(
        [&](std::string_view) {
            if (calls++ == taken) {
                throw std::runtime_error("full");
            }
        },
        small_chunks());
    define(writer);
    std::size_t given = 0;
    const auto give_all = [&] {
        for (const Sent& message : messages) {
            put(writer, message, static_cast<std::uint32_t>(++given));
        }
    };
    EXPECT_EQ(test::refusal(give_all), "full");
    EXPECT_EQ(writer.bytes(), whole.ends[taken - 1]);
    EXPECT_EQ(writer.messages(), whole.messages[taken - 1]);
    EXPECT_GT(given, writer.messages());
    const auto& counts = writer.messages_of_channels();
    EXPECT_EQ(counts.at(0) + counts.at(1), writer.messages());
}

TEST(McapStreamWriter, RefusesWhatIsNotThere) {
    McapStreamWriter writer([](std::string_view) {});
    EXPECT_THROW(writer.add_channel(1, "/text", "cdr"), std::out_of_range);
    EXPECT_THROW(writer.write({0, 0, 0, 0, {}}), std::out_of_range);
}

TEST(McapFile, GrowsUnderItsNameAndIsWholeAtAnyTime) {
    const TemporaryFolder folder;
    const std::vector<Sent> messages = some_messages();
    McapFile file(folder.file("a.mcap"), McapFile::Existing::refused, small_chunks());
    define(file);
    std::size_t seen = 0;
    for (std::uint32_t i = 0; i < messages.size(); ++i) {
        put(file, messages[i], i + 1);
        const Read read = read_back(folder.file("a.mcap"));
        EXPECT_TRUE(std::equal(read.messages.begin(), read.messages.end(), messages.begin()));
        seen = std::max(seen, read.messages.size());
    }
    EXPECT_GT(seen, messages.size() / 2);
    file.finish();
    EXPECT_EQ(file.bytes(), std::filesystem::file_size(folder.file("a.mcap")));
    EXPECT_EQ(read_back(folder.file("a.mcap")).messages, messages);
    struct stat facts {};
    ASSERT_EQ(::stat(folder.file("a.mcap").c_str(), &facts), 0);
    EXPECT_EQ(facts.st_mode & 07027U, 0U);
}

TEST(McapFile, LeavesWhatIsThereUnlessToldOtherwise) {
    const TemporaryFolder folder;
    const std::string path = folder.write("a.mcap", "somebody's");
    EXPECT_THROW(McapFile(path, McapFile::Existing::refused), std::invalid_argument);
    EXPECT_EQ(std::filesystem::file_size(path), 10U);
    McapFile file(path, McapFile::Existing::replaced);
    EXPECT_THAT(test::refusal([&] { McapFile(path, McapFile::Existing::replaced); }),
                AllOf(HasSubstr(path), HasSubstr("another program is writing it")));
    file.finish();
    EXPECT_EQ(read_back(path).problem, "");
}

/// /dev/full is a disk without room.
TEST(McapFile, SaysThatTheDiskIsFull) {
    EXPECT_THAT(test::refusal([] { McapFile("/dev/full", McapFile::Existing::refused); }),
                AllOf(HasSubstr("/dev/full"), HasSubstr("No space left")));
}

}  // namespace
}  // namespace disparityd::formats
