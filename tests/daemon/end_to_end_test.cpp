// SPDX-License-Identifier: Apache-2.0
//
// The real daemon, from outside: what it serves, how it reloads, how it stops.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <vector>

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "clients/cpp/disparity_client.hpp"
#include "obstacles/scan_options.h"
#include "proto/products.h"
#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using std::chrono::steady_clock;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using namespace std::chrono_literals;

using EndToEndTest = DaemonTest;

/// Addresses that a process has reserved.
rlim_t virtual_mib(pid_t pid) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/status");
    for (std::string word; file >> word;) {
        if (rlim_t kib = 0; word == "VmSize:" && file >> kib) {
            return kib >> 10;
        }
    }
    return 0;
}

/// Says whether the depth errors are those of step 13 of docs/algorithm.md.
void expect_depth_errors(const disparity::Frame& frame) {
    const std::vector<std::uint8_t>& measured = frame.plane(disparity::Product::confidence)->bytes;
    std::vector<std::int16_t> d16(measured.size());
    std::vector<std::uint16_t> error(measured.size());
    std::memcpy(d16.data(), frame.plane(disparity::Product::disparity)->bytes.data(), 2 * d16.size());
    std::memcpy(error.data(), frame.plane(disparity::Product::depth_error)->bytes.data(), 2 * error.size());
    const double k = std::round(16 * frame.f * frame.baseline_mm);
    const double sigma = 16 * ScanOptions{}.subpixel_error_px;
    int compared = 0;
    for (std::size_t i = 0; i < measured.size(); ++i) {
        const double n = d16[i] + std::round(16 * frame.disparity_offset);
        if (measured[i] == 0) {
            ASSERT_EQ(error[i], 0) << "pixel " << i;
        } else if (n > 0) {
            const double wanted = std::clamp(k * sigma / (n * n), 1.0, 65535.0);
            ASSERT_NEAR(error[i], wanted, 1 + wanted / 100) << "pixel " << i;  // sigma is rounded to 1/256 px
            ++compared;
        }
    }
    EXPECT_GT(compared, 1000);
}

/// The right image has at x - d what the left one has at x, unlike what it has at x.
void expect_shifted_right_image(const disparity::Frame& frame) {
    const auto& left = frame.plane(disparity::Product::left)->bytes;
    const auto& right = frame.plane(disparity::Product::right)->bytes;
    std::vector<std::int16_t> d16(left.size());
    std::memcpy(d16.data(), frame.plane(disparity::Product::disparity)->bytes.data(), 2 * d16.size());
    double shifted = 0;
    double unshifted = 0;
    for (std::size_t i = 0; i < d16.size(); ++i) {
        const int d = (d16[i] + 8) / 16;
        if (d16[i] != frame.invalid && d > 0 && d <= static_cast<int>(i % frame.width)) {
            shifted += std::abs(left[i] - right[i - static_cast<std::size_t>(d)]);
            unshifted += std::abs(left[i] - right[i]);
        }
    }
    EXPECT_GT(unshifted, 0);
    EXPECT_LT(shifted, unshifted / 2);
}

TEST_F(EndToEndTest, TheSameFrameOnEveryWayOut) {
    disparity::Subscription all;
    std::vector<std::string> switches;
    for (const proto::ProductFacts& product : proto::products) {
        all.products.push_back(static_cast<disparity::Product>(product.number));
        if (!product.key.empty()) {
            switches.insert(switches.end(), {"--set", std::string(product.key) + "=true"});
        }
    }
    // Images as captured are served in the size of the rectified ones.
    const auto daemon = start_ready(
        config_text("scene:vga@15?width=160&height=88&loop=8", 160, 88, "[log]\nlevel = \"debug\"\n"), switches);
    disparity::SharedMemoryReader memory(shared_memory_name());
    disparity::SocketClient tcp(daemon->address("tcp:"));
    tcp.subscribe(all);
    all.compressed = true;
    disparity::SocketClient local(daemon->address("unix:"));
    local.subscribe(all);

    std::map<std::uint64_t, disparity::Frame> by_memory;
    std::map<std::uint64_t, disparity::Frame> by_tcp;
    std::map<std::uint64_t, disparity::Frame> by_unix;
    const auto on_all_ways = [&] {
        return std::count_if(by_memory.begin(), by_memory.end(), [&](const auto& frame) {
            return by_tcp.contains(frame.first) && by_unix.contains(frame.first);
        });
    };
    // On a busy machine each reader misses frames of its own.
    for (const auto end = steady_clock::now() + DaemonProcess::patience;
         on_all_ways() < 5 && steady_clock::now() < end;) {
        disparity::Frame frame;
        ASSERT_EQ(memory.read(frame, 10s), disparity::ReadResult::frame);
        by_memory[frame.publish_index] = frame;
        ASSERT_EQ(tcp.read(frame, 10s), disparity::ReadResult::frame);
        by_tcp[frame.publish_index] = frame;
        ASSERT_EQ(local.read(frame, 10s), disparity::ReadResult::frame);
        by_unix[frame.publish_index] = frame;
    }
    int compared = 0;
    for (const auto& [index, first] : by_memory) {
        if (!by_tcp.contains(index) || !by_unix.contains(index)) {
            continue;
        }
        ++compared;
        for (const disparity::Frame* other : {&by_tcp[index], &by_unix[index]}) {
            EXPECT_EQ(first.sequence, other->sequence);
            EXPECT_EQ(first.monotonic_ns, other->monotonic_ns);
            EXPECT_EQ(first.realtime_ns, other->realtime_ns);
            EXPECT_EQ(first.dropped_before, other->dropped_before);
            EXPECT_EQ(first.calibration_id, other->calibration_id);
            EXPECT_EQ(first.f, other->f);
            EXPECT_EQ(first.cx, other->cx);
            EXPECT_EQ(first.cy, other->cy);
            EXPECT_EQ(first.baseline_mm, other->baseline_mm);
            EXPECT_EQ(first.disparity_offset, other->disparity_offset);
            EXPECT_EQ(first.d_min, other->d_min);
            EXPECT_EQ(first.disparities, other->disparities);
            EXPECT_EQ(first.invalid, other->invalid);
            EXPECT_EQ(first.flags, other->flags);
            EXPECT_EQ(first.width, other->width);
            EXPECT_GT(other->age_ns, 0);
            EXPECT_LT(other->age_ns, 10'000'000'000);
            for (const disparity::Product product : all.products) {
                const disparity::PlaneData* mine = first.plane(product);
                const disparity::PlaneData* theirs = other->plane(product);
                ASSERT_TRUE(mine != nullptr && theirs != nullptr);
                EXPECT_EQ(mine->bytes, theirs->bytes) << "product " << static_cast<int>(product);
            }
        }
        EXPECT_EQ(first.width, 160U);
        EXPECT_EQ(first.height, 88U);
        EXPECT_GT(first.f, 0);
        EXPECT_GT(first.baseline_mm, 0);
        EXPECT_EQ(first.invalid, -16);
        expect_depth_errors(first);
        expect_shifted_right_image(first);
    }
    EXPECT_GE(compared, 5);
}

// The right half is masked, and with it the sectors of the right hand.
TEST_F(EndToEndTest, WhatShowsTheRobotItselfIsInNoProduct) {
    const auto daemon = start_ready(config_text(
        scene, 160, 88, "[mask]\npolygons = [\"80,0 159,0 159,87 80,87\"]\n[scan]\nenabled = true\nsectors = 8\n"));
    disparity::SocketClient client(daemon->address("tcp:"));
    disparity::Subscription wanted;
    wanted.products = {disparity::Product::disparity, disparity::Product::confidence, disparity::Product::depth,
                       disparity::Product::scan};
    client.subscribe(wanted);
    disparity::Frame frame;
    ASSERT_EQ(client.read(frame, 10s), disparity::ReadResult::frame);
    const std::vector<std::uint8_t>& confidence = frame.plane(disparity::Product::confidence)->bytes;
    std::vector<std::int16_t> d16(confidence.size());
    std::vector<std::uint16_t> depth(confidence.size());
    std::memcpy(d16.data(), frame.plane(disparity::Product::disparity)->bytes.data(), 2 * d16.size());
    std::memcpy(depth.data(), frame.plane(disparity::Product::depth)->bytes.data(), 2 * depth.size());
    int measured = 0;
    for (std::size_t i = 0; i < d16.size(); ++i) {
        if (i % frame.width < 80) {
            measured += confidence[i] != 0 && depth[i] != 0 ? 1 : 0;
            continue;
        }
        ASSERT_EQ(d16[i], frame.invalid) << i;
        ASSERT_EQ(confidence[i], 0) << i;
        ASSERT_EQ(depth[i], 0) << i;
    }
    EXPECT_GT(measured, 2000);
    const auto scan = frame.scan();
    ASSERT_TRUE(scan);
    for (std::size_t s = 0; s < 3; ++s) {  // the right-most first
        EXPECT_EQ(scan->sectors[s].state, disparity::SectorState::masked) << s;
        EXPECT_EQ(scan->sectors[s].free_m, 0) << s;
        EXPECT_EQ(scan->sectors[s].trust, 1) << s;
    }
    EXPECT_NE(scan->sectors[6].state, disparity::SectorState::masked);
    EXPECT_GT(scan->sectors[6].trust, 100);
    EXPECT_EQ(scan->sectors[6].doubts, 0U);
}

// The scene has things at 1 to 10 m.
TEST_F(EndToEndTest, LimitsOfDistanceAreNotThoseOfTheScan) {
    const auto daemon = start_ready(config_text(scene, 160, 88,
                                                "[output]\nmin_distance_m = 2.4\nmax_distance_m = 2.5\n[scan]\n"
                                                "enabled = true\n"));
    disparity::SocketClient client(daemon->address("tcp:"));
    disparity::Subscription wanted;
    wanted.products = {disparity::Product::depth, disparity::Product::confidence, disparity::Product::scan};
    client.subscribe(wanted);
    disparity::Frame frame;
    ASSERT_EQ(client.read(frame, 10s), disparity::ReadResult::frame);
    const std::vector<std::uint8_t>& confidence = frame.plane(disparity::Product::confidence)->bytes;
    std::vector<std::uint16_t> depth(confidence.size());
    std::memcpy(depth.data(), frame.plane(disparity::Product::depth)->bytes.data(), 2 * depth.size());
    for (std::size_t i = 0; i < depth.size(); ++i) {
        ASSERT_TRUE(depth[i] == 0 || (depth[i] >= 2400 && depth[i] <= 2500)) << depth[i];
        ASSERT_EQ(depth[i] == 0, confidence[i] == 0) << i;
    }
    const auto scan = frame.scan();
    ASSERT_TRUE(scan);
    EXPECT_TRUE(std::any_of(scan->sectors.begin(), scan->sectors.end(), [](const disparity::ScanSector& sector) {
        return sector.state == disparity::SectorState::occupied && (sector.distance_m < 2.2 || sector.distance_m > 2.7);
    }));
}

TEST_F(EndToEndTest, StatusTellsHowItGoes) {
    const auto daemon = start_ready(config_text());
    WireClient client = subscriber(daemon->address("tcp:"), {v1::DISPARITY}, "curious");
    for (int i = 0; i < 5; ++i) {
        ASSERT_TRUE(client.receive_frame());
    }
    const v1::Status now = status(client);
    EXPECT_EQ(now.state(), "running") << now.detail();
    EXPECT_EQ(now.source(), scene);
    EXPECT_EQ(now.method(), "census");
    EXPECT_FALSE(now.backend().empty());
    EXPECT_EQ(now.workers(), 1U);
    EXPECT_GE(now.published(), 5U);
    EXPECT_GE(now.captured(), now.published());
    EXPECT_GT(now.rate(), 0);
    EXPECT_GT(now.uptime_s(), 0);
    ASSERT_GE(now.steps_size(), 3);
    EXPECT_EQ(now.steps(now.steps_size() - 1).name(), "total");
    EXPECT_GT(now.steps(now.steps_size() - 1).p50_us(), 0);
    ASSERT_EQ(now.clients_size(), 1);
    EXPECT_EQ(now.clients(0).name(), "curious");
    EXPECT_GE(now.clients(0).frames_sent(), 5U);
    EXPECT_FALSE(now.record().active());
}

TEST_F(EndToEndTest, StopsCleanly) {
    for (const int signal : {SIGTERM, SIGINT}) {
        const auto daemon = start_ready(config_text());
        WireClient client = subscriber(daemon->address("unix:"), {v1::DISPARITY});
        ASSERT_TRUE(client.receive_frame());
        const std::string object = "/dev/shm/disparityd." + shared_memory_name();
        EXPECT_TRUE(std::filesystem::exists(object));
        struct stat mode {};
        ASSERT_EQ(stat(object.c_str(), &mode), 0);
        EXPECT_EQ(mode.st_mode & 0777, 0640U);
        daemon->send_signal(signal);
        EXPECT_EQ(daemon->wait_for_exit(), 0) << daemon->log();
        EXPECT_TRUE(client.is_closed());
        EXPECT_FALSE(std::filesystem::exists(object));
        EXPECT_FALSE(std::filesystem::exists(folder_.path() + "/d.sock"));
    }
}

TEST_F(EndToEndTest, ReloadBringsAnotherGeometryToConnectedClients) {
    const auto daemon = start_ready(config_text());
    WireClient client = subscriber(daemon->address("tcp:"), {v1::DISPARITY});
    disparity::SharedMemoryReader memory(shared_memory_name());
    disparity::Frame frame;
    ASSERT_EQ(memory.read(frame, 10s), disparity::ReadResult::frame);
    EXPECT_EQ(frame.width, 160U);
    const auto before = client.receive_frame();
    ASSERT_TRUE(before);
    folder_.write("d.toml", config_text(scene, 96, 64));
    daemon->send_signal(SIGHUP);
    auto message = client.receive_frame(30s);
    std::uint64_t index = before->envelope.frame().publish_index();
    while (message && message->envelope.frame().geometry().width() == 160) {
        EXPECT_EQ(message->envelope.frame().publish_index(), ++index);
        message = client.receive_frame(30s);
    }
    ASSERT_TRUE(message) << daemon->log();
    EXPECT_EQ(message->envelope.frame().publish_index(), ++index);
    EXPECT_EQ(message->envelope.frame().geometry().width(), 96U);
    EXPECT_EQ(message->payload.size(), 96U * 64 * 2);
    EXPECT_NE(message->envelope.frame().flags() & v1::DISCONTINUITY, 0U);
    do {
        ASSERT_EQ(memory.read(frame, 10s), disparity::ReadResult::frame);
    } while (frame.width == 160);
    EXPECT_EQ(frame.width, 96U);
}

TEST_F(EndToEndTest, AReloadWithOtherSlotsIsNoEndForReaders) {
    const auto daemon = start_ready(config_text());
    disparity::SharedMemoryReader memory(shared_memory_name());
    disparity::Frame frame;
    ASSERT_EQ(memory.read(frame, 10s), disparity::ReadResult::frame);
    std::string config = config_text();
    config.insert(config.find("[socket]"), "slots = 8\n");
    folder_.write("d.toml", config);
    daemon->send_signal(SIGHUP);
    const auto is_loaded = [&] {
        const std::string log = daemon->log();
        const std::size_t loading = log.find("loading the configuration again");
        return loading != std::string::npos && log.find("serving scene", loading) != std::string::npos;
    };
    while (!is_loaded()) {
        ASSERT_EQ(memory.read(frame, 30s), disparity::ReadResult::frame) << memory.why_gone();
    }
    EXPECT_EQ(memory.read(frame, 30s), disparity::ReadResult::frame) << memory.why_gone();
}

TEST_F(EndToEndTest, AReloadTellsWhichAddressesCameAndWent) {
    const auto daemon = start_ready(config_text());
    std::string config = config_text();
    config.replace(config.find("/d.sock"), 7, "/e.sock");
    folder_.write("d.toml", config);
    daemon->send_signal(SIGHUP);
    EXPECT_TRUE(daemon->wait_for_log("no longer serving at unix:" + folder_.path() + "/d.sock")) << daemon->log();
    EXPECT_TRUE(daemon->wait_for_log(" serving at unix:" + folder_.path() + "/e.sock")) << daemon->log();
    EXPECT_THAT(daemon->log(), Not(HasSubstr("no longer serving at tcp"))) << "that one has stayed";
}

TEST_F(EndToEndTest, ClientsOutliveACameraThatIsNotThere) {
    const auto daemon = start_ready(config_text());
    WireClient client = subscriber(daemon->address("tcp:"), {v1::DISPARITY});
    ASSERT_TRUE(client.receive_frame());
    folder_.write("d.toml", config_text("v4l2:64x16?device=/dev/there-is-none"));
    daemon->send_signal(SIGHUP);
    ASSERT_TRUE(daemon->wait_for_log("no camera /dev/there-is-none: plug it in")) << daemon->log();
    v1::Status now = status(client);
    while (!now.has_camera()) {
        now = status(client);
    }
    EXPECT_EQ(now.state(), "waiting");
    EXPECT_EQ(now.camera().state(), "absent");
    v1::Envelope request;
    request.mutable_camera_request();
    ASSERT_TRUE(client.send(request));
    auto answer = client.receive();
    while (answer && !answer->envelope.has_error()) {
        answer = client.receive();
    }
    ASSERT_TRUE(answer);
    EXPECT_THAT(answer->envelope.error().message(), HasSubstr("camera: there is none at the moment"));
    EXPECT_FALSE(answer->envelope.error().closing());
    folder_.write("d.toml", config_text());
    daemon->send_signal(SIGHUP);
    EXPECT_TRUE(client.receive_frame(30s)) << daemon->log();
}

TEST_F(EndToEndTest, BadReloadChangesNothing) {
    const auto daemon = start_ready(config_text());
    WireClient client = subscriber(daemon->address("tcp:"), {v1::DISPARITY});
    ASSERT_TRUE(client.receive_frame());
    const std::vector<std::pair<std::string, std::string>> cases{
        {config_text() + "[match]\nd = 1\n", "each key and each section once"},
        {config_text(scene, 160, 88, "[log]\nlevel = \"loud\"\n"), "[log] level"},
        {config_text("/nowhere/recording.mkv"), "/nowhere/recording.mkv"},
    };
    for (const auto& [text, expected] : cases) {
        folder_.write("d.toml", text);
        daemon->send_signal(SIGHUP);
        ASSERT_TRUE(daemon->wait_for_log(expected)) << daemon->log();
        ASSERT_TRUE(client.receive_frame());
    }
    EXPECT_THAT(daemon->log(), HasSubstr("nothing is changed"));
    const v1::Status now = status(client);
    EXPECT_EQ(now.state(), "running");
    EXPECT_THAT(now.notices(), Contains(HasSubstr("refused at the last reload")));
    EXPECT_EQ(now.geometry().width(), 160U);
}

// Everything large is allocated before the old configuration stops.
TEST_F(EndToEndTest, AReloadThatFindsNoMemoryChangesNothing) {
#if defined(DISPARITYD_SANITIZED)
    GTEST_SKIP() << "sanitizers reserve all addresses there are";
#endif
    if (!std::string(DISPARITYD_EMULATOR).empty()) {
        GTEST_SKIP() << "the limit would be the emulator's";
    }
    const auto daemon = start_ready(config_text());
    WireClient client = subscriber(daemon->address("tcp:"), {v1::DISPARITY});
    ASSERT_TRUE(client.receive_frame());
    const rlim_t enough = (virtual_mib(daemon->pid()) + 600) << 20;  // for all but 32 slots of this size
    const rlimit limit{enough, enough};
    ASSERT_EQ(prlimit(daemon->pid(), RLIMIT_AS, &limit, nullptr), 0);
    std::string large = config_text(scene, 2208, 1242);
    large.replace(large.find("workers = 1"), 11, "workers = 1\nslots = 32");
    folder_.write("d.toml", large);
    daemon->send_signal(SIGHUP);
    ASSERT_TRUE(daemon->wait_for_log("nothing is changed")) << daemon->log();
    EXPECT_THAT(daemon->log(), HasSubstr("matching needs"));
    for (int i = 0; i < 10; ++i) {
        ASSERT_TRUE(client.receive_frame()) << daemon->log();
    }
    const v1::Status now = status(client);
    EXPECT_EQ(now.state(), "running");
    EXPECT_EQ(now.geometry().width(), 160U);
    EXPECT_THAT(now.notices(), Contains(HasSubstr("refused at the last reload")));
}

TEST_F(EndToEndTest, ASourceThatEndsLeavesTheDaemonServing) {
    std::string recording;
    {
        const auto daemon = start_ready(config_text());
        WireClient client(daemon->address("unix:"));
        client.hello();
        v1::Envelope request;
        request.mutable_record_start()->set_path("short.mkv");
        ASSERT_TRUE(client.send(request));
        const auto started = client.receive();
        ASSERT_TRUE(started && started->envelope.has_record_status()) << daemon->log();
        recording = started->envelope.record_status().path();
        EXPECT_TRUE(started->envelope.record_status().active());
        while (status(client).record().frames() < 5) {
        }
        // Ended by the daemon's own end, the file must be whole.
        daemon->send_signal(SIGTERM);
        EXPECT_EQ(daemon->wait_for_exit(), 0) << daemon->log();
    }
    const std::string replay = config_text(recording, 160, 88);
    {
        const auto daemon = start_ready(replay, {"--set", "source.pace=fastest"});
        WireClient client(daemon->address("tcp:"));
        client.hello();
        v1::Status now = status(client);
        while (now.state() != "ended") {
            now = status(client);
        }
        EXPECT_THAT(now.detail(), HasSubstr("has ended after"));
        EXPECT_GE(now.published(), 5U);
        EXPECT_EQ(now.dropped(), 0U);
        disparity::SharedMemoryReader memory(shared_memory_name());
        disparity::Frame frame;
        EXPECT_EQ(memory.read(frame, DaemonProcess::patience), disparity::ReadResult::frame);
        // Frames that were under way when the source ended may still come.
        while ((now = status(client)).published() != frame.publish_index + 1) {
            memory.read(frame, 100ms);
        }
        daemon->send_signal(SIGHUP);
        ASSERT_EQ(memory.read(frame, 20s), disparity::ReadResult::frame) << daemon->log();
        EXPECT_GE(frame.publish_index, now.published());
        while (status(client).state() == "running" || status(client).uptime_s() < 0) {
        }
    }
    {
        const std::string latin = folder_.path() + "/caf\xe9.mkv";
        std::filesystem::copy_file(recording, latin);
        const auto daemon = start_ready(config_text(), {"--source", latin});
        WireClient client(daemon->address("tcp:"));
        client.hello();
        EXPECT_THAT(status(client).source(), HasSubstr("caf?.mkv"));
    }
    const std::vector<std::string> to_the_end{"--exit-at-end", "--set", "source.pace=fastest"};
    const auto whole = start(replay, to_the_end);
    EXPECT_EQ(whole->wait_for_exit(30s), 0) << whole->log();
    std::filesystem::resize_file(recording, std::filesystem::file_size(recording) / 2);
    const auto truncated = start(replay, to_the_end);
    EXPECT_EQ(truncated->wait_for_exit(30s), 1) << truncated->log();
    EXPECT_THAT(truncated->log(), HasSubstr("the source failed: "));
    EXPECT_THAT(truncated->log(), HasSubstr(recording));
}

TEST_F(EndToEndTest, StopsWhileTheSourceIsBeingPrepared) {
    // More rows than any machine draws before the signal arrives: a daemon that finished them would serve.
    const auto daemon = start(config_text("scene:hd2k@15?loop=16"));
    ASSERT_TRUE(daemon->wait_for_log("preparing scene:hd2k")) << daemon->log();
    daemon->send_signal(SIGTERM);
    EXPECT_EQ(daemon->wait_for_exit(), 0) << daemon->log();
    EXPECT_THAT(daemon->log(), HasSubstr("stopping: SIGTERM"));
    EXPECT_THAT(daemon->log(), Not(HasSubstr("serving"))) << "the scene was drawn to its end";
}

TEST_F(EndToEndTest, OnlyTheMainThreadTakesSignals) {
    const auto daemon = start_ready(config_text());
    const std::string main_thread = std::to_string(daemon->pid());
    int others = 0;
    for (const auto& thread : std::filesystem::directory_iterator("/proc/" + main_thread + "/task")) {
        std::ifstream status(thread.path() / "status");
        std::string line;
        while (std::getline(status, line) && !line.starts_with("SigBlk:")) {
        }
        if (line.empty()) {
            continue;  // It has ended.
        }
        const bool blocked = std::stoull(line.substr(7), nullptr, 16) >> (SIGTERM - 1) & 1;
        EXPECT_EQ(blocked, thread.path().filename() != main_thread) << thread.path();
        others += blocked ? 1 : 0;
    }
    EXPECT_GT(others, 2);
}

TEST_F(EndToEndTest, RecordingsStayInsideTheirFolder) {
    const auto daemon = start_ready(config_text());
    WireClient client(daemon->address("unix:"));
    client.hello();
    folder_.write("there.mkv", "x");
    for (const std::string path :
         {"../escape.mkv", "/tmp/escape.mkv", "", ".", "there.mkv", "no/such/folder.mkv", ".bash_profile", "-rf",
          ".a.mkv", "-a.mkv", "a.txt", "a\n00:00:00.000 error forged.mkv", "\x1b[31m.mkv"}) {
        v1::Envelope request;
        request.mutable_record_start()->set_path(path);
        ASSERT_TRUE(client.send(request));
        EXPECT_FALSE(client.receive_error().empty()) << path;
    }
    EXPECT_FALSE(std::filesystem::exists("/tmp/escape.mkv"));
    v1::Envelope request;
    request.mutable_record_stop();
    ASSERT_TRUE(client.send(request));
    EXPECT_THAT(client.receive_error(), HasSubstr("nothing is being recorded"));
    request.mutable_record_start()->set_path("a.mkv");
    ASSERT_TRUE(client.send(request));
    ASSERT_TRUE(client.receive()->envelope.has_record_status());
    ASSERT_TRUE(client.send(request));
    EXPECT_THAT(client.receive_error(), HasSubstr("is running"));
    while (status(client).record().frames() < 3) {
    }
    request.mutable_record_stop();
    ASSERT_TRUE(client.send(request));
    const auto done = client.receive();
    ASSERT_TRUE(done && done->envelope.has_record_status());
    EXPECT_FALSE(done->envelope.record_status().active());
    EXPECT_GE(done->envelope.record_status().frames(), 3U);
    EXPECT_EQ(done->envelope.record_status().dropped(), 0U);
    EXPECT_EQ(done->envelope.record_status().error(), "");
    EXPECT_EQ(std::filesystem::file_size(folder_.path() + "/a.mkv"), done->envelope.record_status().bytes());
}

}  // namespace
}  // namespace disparityd::test
