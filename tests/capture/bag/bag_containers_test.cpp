// SPDX-License-Identifier: Apache-2.0
//
// Bags of ROS 2 in SQLite and bags of ROS 1: the same frames as from MCAP, and files that are damaged or hostile.
#include <filesystem>
#include <functional>
#include <random>

#include "tests/capture/bag/bag_fixture.h"
#include "tests/capture/bag/played_bag.h"
#include "tests/formats/db3_writer.h"
#include "tests/formats/ros1_writer.h"
#include "tests/temporary_folder.h"

namespace disparityd::capture {
namespace {

using disparityd::test::bag_start_ns;
using disparityd::test::BagWriter;
using disparityd::test::Db3Features;
using disparityd::test::Ros1Writer;
using disparityd::test::run_sql;
using disparityd::test::TemporaryFolder;
using disparityd::test::write_db3;
using test::height;
using test::numbered_image;
using test::options_of;
using test::period;
using test::play_all;
using test::Played;
using test::refusal;
using test::width;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* left_topic = "/left/image_raw";
constexpr const char* right_topic = "/right/image_raw";

std::string mcap_bag(int frames) {
    BagWriter bag;
    for (int i = 0; i < frames; ++i) {
        const std::int64_t stamp = bag_start_ns + i * period;
        bag.imu("/imu", stamp, 0.5 * i, 9.5);
        bag.camera_info("/left/camera_info", stamp, {});
        bag.camera_info("/right/camera_info", stamp, disparityd::test::CameraInfoFields().right_of(0.12));
        bag.image(left_topic, stamp, numbered_image(width, height, CV_8UC1, i), "mono8");
        bag.image(right_topic, stamp, numbered_image(width, height, CV_8UC1, 100 + i), "mono8");
    }
    return bag.close();
}

std::string ros1_bag(int frames, const std::string& packing, bool index = true) {
    const std::string definition(disparityd::test::ros1_image_type);
    Ros1Writer bag(packing, index);
    const std::uint32_t to_left = bag.connection(left_topic, "sensor_msgs/Image", definition);
    const std::uint32_t to_right = bag.connection(right_topic, "sensor_msgs/Image", definition);
    for (int i = 0; i < frames; ++i) {
        const std::int64_t stamp = bag_start_ns + i * period;
        bag.message(to_left, stamp, disparityd::test::ros1_image(stamp, numbered_image(width, height, CV_8UC1, i)));
        bag.message(to_right, stamp,
                    disparityd::test::ros1_image(stamp, numbered_image(width, height, CV_8UC1, 100 + i)));
        bag.end_chunk();
    }
    return bag.close();
}

void expect_alike(const Played& found, const Played& expected) {
    EXPECT_EQ(found.problem, "");
    EXPECT_EQ(found.frames, expected.frames);
    EXPECT_EQ(found.times, expected.times);
    EXPECT_EQ(found.sequences, expected.sequences);
}

TEST(BagContainers, Db3GivesWhatMcapGives) {
    const TemporaryFolder folder;
    const std::string mcap = folder.write("a.mcap", mcap_bag(3));
    const Played expected = play_all(options_of(mcap));
    ASSERT_EQ(expected.frames.size(), 3U);
    int number = 0;
    for (const Db3Features features : {Db3Features{}, {false, false, false}, {true, true, true}}) {
        const std::string file = folder.file(std::to_string(number++) + ".db3");
        write_db3(mcap, file, features);
        const Played found = play_all(options_of(file));
        expect_alike(found, expected);
        EXPECT_EQ(found.samples.size(), 3U);
        const auto source = open_source(options_of(file));
        ASSERT_TRUE(source->info().calibration);
        EXPECT_NEAR(source->info().calibration->translation[0], -120, 1e-6);
    }
    folder.write("metadata.yaml",
                 "rosbag2_bagfile_information:\n  storage_identifier: sqlite3\n  relative_file_paths: [0.db3]\n"
                 "  compression_format: zstd\n  compression_mode: MESSAGE\n");
    expect_alike(play_all(options_of(folder.path())), expected);
}

TEST(BagContainers, Db3WithAWriteAheadLogIsRead) {
    const TemporaryFolder folder;
    const std::string mcap = folder.write("a.mcap", mcap_bag(3));
    const std::string file = folder.file("#1?%20.db3");
    write_db3(mcap, file);
    run_sql(file, "PRAGMA journal_mode=WAL");
    expect_alike(play_all(options_of(file + "?within_ms=5")), play_all(options_of(mcap)));
    EXPECT_FALSE(std::filesystem::exists(file + "-shm"));
}

TEST(BagContainers, DatabasesThatAreNoBagAreRefused) {
    const TemporaryFolder folder;
    const std::string mcap = folder.write("a.mcap", mcap_bag(2));
    int number = 0;
    const auto problem_after = [&](const std::string& sql) {
        const std::string file = folder.file(std::to_string(number++) + ".db3");
        write_db3(mcap, file);
        run_sql(file, sql);
        return play_all(options_of(file)).problem;
    };
    EXPECT_THAT(problem_after("DROP TABLE topics"), HasSubstr("this database has no table 'topics'"));
    const std::string endless =
        "DROP TABLE messages; CREATE VIEW messages AS WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL SELECT id+1 FROM n) "
        "SELECT id, 1 AS topic_id, id AS timestamp, x'00' AS data FROM n";
    EXPECT_THAT(problem_after(endless), HasSubstr("'messages' in this database is no plain table"));
    EXPECT_THAT(problem_after("ALTER TABLE messages ADD COLUMN x AS (hex(zeroblob(100000000)))"),
                HasSubstr("'messages' in this database is no plain table"));
    EXPECT_THAT(problem_after("UPDATE messages SET topic_id = -1 WHERE id = 6"),
                HasSubstr(".db3: is damaged: message 6 is of topic -1, which is not there"));
    EXPECT_THAT(problem_after("UPDATE topics SET serialization_format = 'protobuf'"),
                HasSubstr("found messages encoded as 'protobuf'"));
    EXPECT_THAT(problem_after("DROP TABLE topics; CREATE TABLE topics AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL "
                              "SELECT i+1 FROM n WHERE i < 170000) SELECT 1 AS id, '' AS name, '' AS type, '' AS "
                              "serialization_format FROM n"),
                HasSubstr("its topics and definitions have more than 16777216 bytes"));
    EXPECT_THAT(problem_after("PRAGMA writable_schema=1; INSERT INTO sqlite_master WITH RECURSIVE n(i) AS (SELECT 1 "
                              "UNION ALL SELECT i+1 FROM n WHERE i < 1500000) SELECT '', 'x', 'x', 0, '' FROM n"),
                HasSubstr("its tables have more rows than a bag has, or do not end"));
    EXPECT_THAT(problem_after("ALTER TABLE messages RENAME COLUMN data TO bytes"), HasSubstr("no such column: data"));
    EXPECT_THAT(refusal([&] { open_source(options_of(folder.write("x.db3", "no database, but some text"))); }),
                HasSubstr("x.db3: is no .db3 bag"));
}

TEST(BagContainers, Ros1GivesWhatMcapGives) {
    const TemporaryFolder folder;
    const Played expected = play_all(options_of(folder.write("a.mcap", mcap_bag(3))));
    for (const std::string packing : {"none", "bz2", "lz4"}) {
        for (const bool index : {true, false}) {
            expect_alike(play_all(options_of(folder.write("a.bag", ros1_bag(3, packing, index)))), expected);
        }
    }
    const std::string file = ros1_bag(9, "none");
    const Played cut = play_all(options_of(folder.write("cut.bag", file.substr(0, file.size() / 2))));
    EXPECT_THAT(cut.problem, HasSubstr("cut.bag: was cut off after"));
    EXPECT_EQ(cut.frames.size(), 4U);
    // Each chunk is as long as the next, with two records of an index behind it.
    const std::size_t last = ros1_bag(8, "none", false).size();
    const Played between = play_all(options_of(folder.write("cut.bag", file.substr(0, last))));
    EXPECT_THAT(between.problem, HasSubstr("cut.bag: was cut off after"));
    EXPECT_EQ(between.frames.size(), 8U);
    // All chunks are there, and nothing of the index.
    const std::size_t all = ros1_bag(9, "none", false).size();
    const Played without = play_all(options_of(folder.write("cut.bag", file.substr(0, all))));
    EXPECT_THAT(without.problem, HasSubstr("cut.bag: was cut off after"));
    EXPECT_EQ(without.frames.size(), 9U);
    EXPECT_THAT(play_all(options_of(folder.write("empty.bag", Ros1Writer().close()))).problem,
                HasSubstr("it has images of none"));
    std::string header;
    for (int i = 0; i < 1001; ++i) {
        header += Ros1Writer::text(std::to_string(i) + "=");
    }
    const std::string many = ros1_bag(2, "none", false) + Ros1Writer::text(header) + Ros1Writer::text("");
    EXPECT_THAT(play_all(options_of(folder.write("many.bag", many))).problem,
                HasSubstr("a record has more than 1000 fields"));
    EXPECT_THAT(refusal([&] { open_source(options_of(folder.write("x.bag", "#ROSBAG V1.2\nsomething"))); }),
                HasSubstr("x.bag: is no bag of ROS 1 in version 2.0"));
}

/// Plays 300 files in each of which some bytes were changed.
void expect_lines(const std::string& name, const std::function<std::string(int)>& made) {
    const TemporaryFolder folder;
    std::mt19937 random(1);
    unsigned told = 0;
    for (int i = 0; i < 300; ++i) {
        std::string file = made(i);
        for (int damage = 0; damage < 1 + i % 5; ++damage) {
            // The first bytes and the last ones are those that say most of the file.
            const std::size_t within = damage % 2 == 0 ? file.size() : std::size_t{4096};
            file[random() % within] = static_cast<char>(random());
        }
        const Played found = play_all(options_of(folder.write(name, file)));
        EXPECT_LE(found.frames.size(), 4U);
        EXPECT_EQ(found.problem.find('\n'), std::string::npos) << found.problem;
        EXPECT_LT(found.problem.size(), 1000U);
        if (!found.problem.empty()) {
            ++told;
            EXPECT_THAT(found.problem, HasSubstr(name));
        }
    }
    EXPECT_GT(told, 30U);
}

TEST(BagContainers, DamageOfRos1IsToldInALine) {
    const std::vector<std::string> files{ros1_bag(4, "none"), ros1_bag(4, "bz2"), ros1_bag(4, "lz4"),
                                         ros1_bag(4, "none", false)};
    expect_lines("a.bag", [&](int i) { return files[static_cast<std::size_t>(i) % files.size()]; });
}

TEST(BagContainers, DamageOfDb3IsToldInALine) {
    const TemporaryFolder folder;
    const std::string mcap = folder.write("a.mcap", mcap_bag(4));
    write_db3(mcap, folder.file("a.db3"));
    std::ifstream in(folder.file("a.db3"), std::ios::binary);
    const std::string file{std::istreambuf_iterator<char>(in), {}};
    expect_lines("a.db3", [&](int i) { return i % 10 == 0 ? file.substr(0, file.size() * 2 / 3) : file; });
}

}  // namespace
}  // namespace disparityd::capture
