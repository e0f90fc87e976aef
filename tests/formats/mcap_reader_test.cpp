// SPDX-License-Identifier: Apache-2.0
//
// Files that were cut off, damaged or made to harm. other_mcap.cjs compares whole ones with another implementation.
#include "formats/mcap_reader.h"

#include <fstream>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/mcap_bag.h"
#include "formats/mcap_chunk.h"
#include "tests/formats/mcap_writer.h"
#include "tests/temporary_folder.h"

namespace disparityd::formats {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr unsigned messages = 20;
constexpr std::size_t message_bytes = 500;

std::string data_of(unsigned number) {
    std::string data(message_bytes, '\0');
    std::mt19937 random(number);
    for (char& byte : data) {
        byte = static_cast<char>(random() % 4);
    }
    return data;
}

std::string file_of(const test::McapFeatures& features) {
    test::McapWriter writer(features);
    const std::uint16_t schema = writer.schema("test_msgs/msg/Text", "ros2msg", "string text");
    const std::uint16_t channel = writer.channel(schema, "/text");
    for (unsigned i = 0; i < messages; ++i) {
        writer.message(channel, i, 100 + i, data_of(i));
    }
    writer.attachment("file", data_of(99));
    return writer.close();
}

test::McapFeatures packed_in(const std::string& packing) {
    test::McapFeatures features;
    features.packing = packing;
    features.chunk_bytes = 3 * message_bytes;
    return features;
}

/// What a file gives: its messages in order, then the end or a refusal.
struct Outcome {
    unsigned read = 0;
    std::string problem;
};

Outcome read_all(const std::string& path) {
    Outcome outcome;
    try {
        McapReader reader(path);
        McapMessage message;
        while (reader.next(message)) {
            EXPECT_EQ(message.sequence, outcome.read);
            const std::string found(message.data.begin(), message.data.end());
            EXPECT_EQ(found, data_of(outcome.read));
            ++outcome.read;
        }
        EXPECT_FALSE(reader.next(message)) << "the end stays the end";
    } catch (const std::exception& error) {
        outcome.problem = error.what();
    }
    return outcome;
}

TEST(McapReader, ReadsEveryPacking) {
    const test::TemporaryFolder folder;
    for (const std::string packing : {"", "zstd", "lz4"}) {
        const Outcome outcome = read_all(folder.write(packing + ".mcap", file_of(packed_in(packing))));
        EXPECT_EQ(outcome.read, messages) << packing;
        EXPECT_EQ(outcome.problem, "") << packing;
    }
}

TEST(McapBag, ConnectionsOfOneTypeShareItsDefinition) {
    const test::TemporaryFolder folder;
    test::McapWriter writer;
    const std::uint16_t schema = writer.schema("test_msgs/msg/Text", "ros2msg", "string text");
    writer.channel(schema, "/a");
    writer.channel(schema, "/b");
    const auto connections = McapBag(folder.write("a.mcap", writer.close())).connections();
    ASSERT_EQ(connections.size(), 2U);
    EXPECT_EQ(*connections.at(0).definition, "string text");
    EXPECT_EQ(connections.at(0).definition, connections.at(1).definition) << "the same object, however long it is";
}

TEST(McapReader, KnowsWhatTheSummarySays) {
    const test::TemporaryFolder folder;
    const McapReader reader(folder.write("a.mcap", file_of(packed_in("zstd"))));
    ASSERT_TRUE(reader.has_summary());
    EXPECT_EQ(reader.definitions().channels().at(0).topic, "/text");
    EXPECT_EQ(*reader.definitions().schemas().at(1).text, "string text");
    EXPECT_EQ(reader.message_count(0), messages);
    test::McapFeatures without = packed_in("zstd");
    without.statistics = false;
    EXPECT_EQ(McapReader(folder.write("b.mcap", file_of(without))).message_count(0), std::nullopt);
}

TEST(McapReader, ASummaryThatIsDamagedCountsAsNone) {
    const test::TemporaryFolder folder;
    std::string file = file_of(packed_in(""));
    file[file.rfind("/text")] = 'x';
    const std::string path = folder.write("a.mcap", file);
    EXPECT_FALSE(McapReader(path).has_summary());
    EXPECT_EQ(read_all(path).read, messages);
}

TEST(McapReader, AFileThatWasCutOffIsReadUpToTheCut) {
    const test::TemporaryFolder folder;
    test::McapFeatures whole = packed_in("");
    whole.chunks = false;
    for (const test::McapFeatures& features : {packed_in("zstd"), packed_in("lz4"), packed_in(""), whole}) {
        const std::string file = file_of(features);
        const std::size_t end = file.find("application/octet-stream");
        unsigned before = 0;
        for (std::size_t size = mcap_magic.size(); size < end; size += 97) {
            const Outcome outcome = read_all(folder.write("cut.mcap", file.substr(0, size)));
            EXPECT_THAT(outcome.problem, AllOf(HasSubstr("cut.mcap: was cut off after " + std::to_string(size))));
            EXPECT_GE(outcome.read, before);
            before = outcome.read;
        }
        EXPECT_EQ(before, messages);
    }
}

TEST(McapReader, AWrongByteIsNoticedOrHarmless) {
    const test::TemporaryFolder folder;
    std::mt19937 random(1);
    for (const std::string packing : {"", "zstd", "lz4"}) {
        const std::string file = file_of(packed_in(packing));
        for (int i = 0; i < 100; ++i) {
            std::string damaged = file;
            damaged[random() % damaged.size()] ^= static_cast<char>(1U << random() % 8);
            const Outcome outcome = read_all(folder.write("damaged.mcap", damaged));
            EXPECT_TRUE(outcome.problem.empty() ? outcome.read == messages
                                                : outcome.problem.find("damaged.mcap: ") != std::string::npos)
                << outcome.problem;
        }
    }
}

TEST(McapReader, ChecksumsOfChunkDataAndAttachmentAreLookedAt) {
    const test::TemporaryFolder folder;
    const auto outcome_of = [&](std::string file, std::size_t place) {
        file[place] ^= 1;
        return read_all(folder.write("a.mcap", file)).problem;
    };
    const std::string chunked = file_of(packed_in(""));
    EXPECT_THAT(outcome_of(chunked, chunked.find(data_of(4)) + 9), HasSubstr("the checksum of a chunk is wrong"));
    test::McapFeatures features;
    features.chunks = false;
    const std::string plain = file_of(features);
    EXPECT_THAT(outcome_of(plain, plain.find(data_of(4)) - 3), HasSubstr("the checksum of the data is wrong"));
    EXPECT_THAT(outcome_of(plain, plain.find(data_of(99)) + 9), HasSubstr("the checksum of an attachment is wrong"));
}

TEST(McapReader, OtherFilesAreRefused) {
    const test::TemporaryFolder folder;
    EXPECT_THAT(read_all(folder.file("none.mcap")).problem, HasSubstr("no such file"));
    EXPECT_THAT(read_all(folder.write("a.mcap", "")).problem, HasSubstr("is no MCAP file: it has 0 bytes"));
    EXPECT_THAT(read_all(folder.write("a.mcap", std::string(100, 'x'))).problem, HasSubstr("does not begin as one"));
}

std::string number(std::uint64_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) {
        text.push_back(static_cast<char>(value >> (8 * i)));
    }
    return text;
}

std::string record(int opcode, const std::string& content) {
    return number(static_cast<std::uint64_t>(opcode), 1) + number(content.size(), 8) + content;
}

TEST(McapReader, SizesAreCheckedBeforeMemoryIsTaken) {
    const test::TemporaryFolder folder;
    const auto problem_of = [&](const std::string& records) {
        return read_all(folder.write("a.mcap", std::string(mcap_magic) + records)).problem;
    };
    EXPECT_THAT(problem_of(number(6, 1) + number(std::uint64_t{1} << 60U, 8)), HasSubstr("was cut off"));
    const std::string huge =
        number(0, 16) + number(std::uint64_t{1} << 40U, 8) + number(0, 4) + number(4, 4) + "zstd" + number(0, 8);
    EXPECT_THAT(problem_of(record(6, huge)),
                HasSubstr("a chunk has 1099511627776 bytes, allowed are up to " + std::to_string(mcap_most_bytes)));
    const std::string unknown = number(0, 16) + number(1, 8) + number(0, 4) + number(3, 4) + "xz\n" + number(0, 8);
    EXPECT_THAT(problem_of(record(6, unknown)), HasSubstr("packed by 'xz?', allowed are zstd, lz4 and nothing"));
    EXPECT_THAT(problem_of(record(3, number(1, 2) + number(0xffffffff, 4))), HasSubstr("a record is too short"));
    EXPECT_THAT(problem_of(record(5, number(7, 2) + number(0, 20))), HasSubstr("channel 7, which is not there"));
    std::string schemas;
    for (unsigned i = 1; i < 20; ++i) {
        schemas += record(3, number(i, 2) + number(0, 8) + number(1 << 20, 4) + std::string(1 << 20, 'x'));
    }
    EXPECT_THAT(problem_of(schemas), HasSubstr("more than 16 MiB together"));
}

}  // namespace
}  // namespace disparityd::formats
