// SPDX-License-Identifier: Apache-2.0
//
// Writes one SVO2 file of each kind that a reader may meet, with what it holds as a line of JSON each.
//   svo2_files FOLDER
// A kind that FFmpeg has no encoder for here is named on standard error and left out.
#include <fstream>
#include <iostream>
#include <utility>

#include <nlohmann/json.hpp>

#include "tests/formats/svo2_writer.h"

namespace {

using namespace disparityd;
using Json = nlohmann::json;
using Kinds = std::vector<std::pair<std::string, test::Svo2File>>;

template <class Change>
test::Svo2File file(Change&& change) {
    test::Svo2File made;
    change(made);
    return made;
}

void add_payloads(Kinds& kinds) {
    using enum test::Svo2Payload;
    const std::pair<const char*, test::Svo2Payload> payloads[] = {
        {"h264", h264},
        {"h265", h265},
        {"h264-lossless", h264_lossless},
        {"h264-lossless-444", h264_lossless_444},
        {"png", png},
        {"zstd-bgra", zstd_bgra},
        {"h265-lossless", h265_lossless},
        {"encrypted", encrypted},
        {"zstd-bgr", zstd_bgr},
        {"zstd-yuyv", zstd_yuyv},
        {"zstd-grey", zstd_grey},
    };
    for (const auto& [name, payload] : payloads) {
        kinds.emplace_back(name, file([payload = payload](auto& f) { f.payload = payload; }));
    }
}

/// What the descriptions disagree about, and what a complete file may have or not.
void add_sound(Kinds& kinds) {
    kinds.emplace_back("stamps-us", file([](auto& f) { f.stamp_unit_ns = 1'000; }));
    kinds.emplace_back("stamps-ms", file([](auto& f) { f.stamp_unit_ns = 1'000'000; }));
    kinds.emplace_back("stamps-s",
                       file([](auto& f) { f.stamp_unit_ns = 1'000'000'000, f.rate = f.samples_per_frame = 1; }));
    kinds.emplace_back("width-of-one-eye", file([](auto& f) { f.width_of_one_eye = true; }));
    kinds.emplace_back("frames-lost", file([](auto& f) { f.lost = {3, 4, 8}; }));
    kinds.emplace_back("topics-not-known", file([](auto& f) { f.more_topics = {"Camera_SN1/depth", "notes", ""}; }));
    kinds.emplace_back("no-header", file([](auto& f) { f.has_header = false; }));
    kinds.emplace_back("no-sensors", file([](auto& f) { f.has_sensors = false; }));
    kinds.emplace_back("no-footer", file([](auto& f) { f.has_footer = false; }));
    kinds.emplace_back("no-chunks", file([](auto& f) { f.mcap.chunks = false; }));
    kinds.emplace_back("chunks-zstd", file([](auto& f) { f.mcap.packing = "zstd"; }));
    kinds.emplace_back("chunks-lz4", file([](auto& f) { f.mcap.packing = "lz4"; }));
    kinds.emplace_back("hd2k", file([](auto& f) { f.eye_width = 2208, f.height = 1242, f.rate = 15, f.frames = 3; }));
    kinds.emplace_back("vga", file([](auto& f) { f.eye_width = 672, f.height = 376, f.rate = 100; }));
}

/// What is broken in one place.
void add_damaged(Kinds& kinds) {
    constexpr int damaged = 6;
    const auto changed = [&](const char* name, auto change) {
        kinds.emplace_back(name, file([&](auto& f) {
                               f.change = [change](std::string& message, int number) {
                                   if (number == damaged) {
                                       change(message);
                                   }
                               };
                           }));
    };
    changed("message-empty", [](std::string& m) { m.clear(); });
    changed("message-short", [](std::string& m) { m.resize(6); });
    changed("message-cut", [](std::string& m) { m.resize(m.size() - 40); });
    changed("message-longer", [](std::string& m) { m += "more"; });
    changed("size-too-big", [](std::string& m) { m[3] = '\x7F'; });
    changed("payload-size-too-big", [](std::string& m) { m[7] = '\xFF'; });
    changed("payload-size-zero", [](std::string& m) { m.replace(4, 4, 4, '\0'); });
    changed("payload-damaged", [](std::string& m) { m.replace(m.size() / 2, 200, 200, '\x55'); });
    changed("stamp-zero", [](std::string& m) { m.replace(m.size() - 0x20, 8, 8, '\0'); });
    changed("stamp-far", [](std::string& m) { m.replace(m.size() - 0x20, 8, 8, '\xFF'); });
    changed("number-negative", [](std::string& m) { m.replace(m.size() - 8, 4, 4, '\xFF'); });
    changed("number-twice", [](std::string& m) { m[m.size() - 8] = damaged - 1; });
    changed("size-below-wrong", [](std::string& m) { m.replace(m.size() - 56, 8, 8, '\x11'); });
    kinds.emplace_back("frames-unwritten", file([](auto& f) { f.unwritten = {2, 7}; }));
    kinds.emplace_back("no-first-key", file([](auto& f) { f.unwritten = {0, 1}; }));
    kinds.emplace_back("no-frames", file([](auto& f) { f.unwritten = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}; }));
    kinds.emplace_back("no-video-topic", file([](auto& f) { f.video_topic = "Camera_SN31234567/video"; }));
    kinds.emplace_back("header-no-json", file([](auto& f) { f.header_text = "{\"header\":"; }));
    kinds.emplace_back("header-no-base64", file([](auto& f) { f.header_text = R"({"header":"%%%%"})"; }));
    kinds.emplace_back("header-short", file([](auto& f) { f.header_text = R"({"header":"AAUAAA=="})"; }));
    kinds.emplace_back("header-other-type",
                       file([](auto& f) { f.header_text = R"({"header":[1,2],"Calib_acc":null})"; }));
}

Json described(const std::string& path, const test::Svo2File& made) {
    Json times = Json::array();
    for (const int frame : test::svo2_frame_numbers(made)) {
        times.push_back(std::to_string(test::svo2_frame_ns(made, frame)));
    }
    return {{"path", path},
            {"width", 2 * made.eye_width},
            {"height", made.height},
            {"disparity", made.disparity},
            {"serial", made.serial},
            {"sound", !made.change && made.header_text.empty() && made.video_topic.empty()},
            {"imu_frequency_hz", made.rate * made.samples_per_frame},
            {"rate", made.rate},
            {"unit", made.stamp_unit_ns},
            {"frames", test::svo2_frame_numbers(made)},
            {"times", times},
            {"samples", made.has_sensors ? made.frames * made.samples_per_frame : 0}};
}

void write(const std::string& path, const std::string& bytes) {
    if (!(std::ofstream(path, std::ios::binary) << bytes)) {
        throw std::runtime_error(path + ": cannot be written");
    }
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2) {
        std::cerr << "svo2_files FOLDER\n";
        return 2;
    }
    const std::string folder = std::string(arguments[1]) + "/";
    Kinds kinds;
    add_payloads(kinds);
    add_sound(kinds);
    add_damaged(kinds);
    for (const auto& [name, made] : kinds) {
        if (!test::can_write(made.payload)) {
            std::cerr << name << ": left out, FFmpeg has no encoder for it here\n";
            continue;
        }
        const std::string path = folder + name + ".svo2";
        write(path, test::svo2_bytes(made));
        std::cout << described(path, made).dump() << "\n";
    }
    // Not what an MCAP reader takes, so no line.
    if (const test::Svo2File whole; test::can_write(whole.payload)) {
        const std::string bytes = test::svo2_bytes(whole);
        write(folder + "cut.svo2", bytes.substr(0, bytes.size() / 2));
        write(folder + "cut-in-magic.svo2", bytes.substr(0, 5));
    }
    write(folder + "version-1.svo", test::svo1_bytes());
    write(folder + "version-1-renamed.svo2", test::svo1_bytes());
    write(folder + "empty.svo2", "");
    return 0;
}
