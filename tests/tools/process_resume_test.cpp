// SPDX-License-Identifier: Apache-2.0
//
// `process --resume` after a crash, and the manifests that `verify` checks.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/calibration/calibration_texts.h"
#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"
#include "tools/images/image_file.h"

namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using Files = std::map<std::string, std::string>;

class ProcessResumeTest : public FolderTest {
protected:
    void SetUp() override {
        FolderTest::SetUp();
        make_kitti_folder(path("drive"), 4, 64, 32);
        make_recording(path("walk.mkv"), 6, 80, 40);
    }

    std::vector<std::string> words(const std::string& folder, std::vector<std::string> more = {}) const {
        std::vector<std::string> all{
            "process", path("drive"), path("walk.mkv"), "scene:vga?width=96&height=64&frames=3",
            "-o",      path(folder),  "--disparities",  "16",
            "--pfm"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }

    Outcome process(const std::string& folder, std::vector<std::string> more = {}) const {
        return run(DISPARITYCTL, words(folder, std::move(more)));
    }

    Outcome verify(const std::string& folder, const std::string& against = "") const {
        std::vector<std::string> all{"verify", path(folder)};
        if (!against.empty()) {
            all.insert(all.end(), {"--against", path(against)});
        }
        return run(DISPARITYCTL, all);
    }

    /// Every file of every source, hidden ones too.
    std::map<std::string, Files> all_in(const std::string& folder) const {
        std::map<std::string, Files> all;
        for (const auto& entry : std::filesystem::directory_iterator(path(folder))) {
            all[entry.path().filename()] = files_in(entry.path());
        }
        return all;
    }

    nlohmann::json manifest(const std::string& folder) const {
        return nlohmann::json::parse(read_file(path(folder + "/manifest.json")));
    }
};

// DISPARITYD_KILLS asks for more rounds.
TEST_F(ProcessResumeTest, KilledAtAnyMomentAndResumedGivesTheSameFiles) {
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(process("whole").exit_code, 0);
    const auto usual = std::chrono::steady_clock::now() - start;
    const auto whole = all_in("whole");
    const char* const asked = std::getenv("DISPARITYD_KILLS");
    const int rounds = asked == nullptr ? 5 : std::atoi(asked);
    std::mt19937 random(std::random_device{}());
    int killed = 0;
    for (int i = 0; i < rounds || (killed == 0 && i < 10 * rounds); ++i) {
        const double share = std::uniform_real_distribution<double>(0, 1)(random);
        SCOPED_TRACE("round " + std::to_string(i) + " at " + std::to_string(share));
        Program program(DISPARITYCTL, words("out", {"--resume"}));
        std::this_thread::sleep_for(std::chrono::duration_cast<std::chrono::nanoseconds>(usual) * share);
        program.send(SIGKILL);
        const Outcome ended = program.wait();
        ASSERT_TRUE(ended.exit_code == 0 || ended.exit_code == 128 + SIGKILL) << ended.err;
        killed += ended.exit_code == 0 ? 0 : 1;
        if (ended.exit_code == 0) {
            EXPECT_EQ(all_in("out"), whole);
            std::filesystem::remove_all(path("out"));
        }
    }
    EXPECT_GT(killed, 0) << "every run had ended before its kill";
    const Outcome last = process("out", {"--resume"});
    ASSERT_EQ(last.exit_code, 0) << last.err;
    EXPECT_EQ(all_in("out"), whole) << "after " << killed << " kills";
    EXPECT_EQ(verify("out", "whole").exit_code, 0);
}

TEST_F(ProcessResumeTest, WhatIsFinishedIsLeftAlone) {
    ASSERT_EQ(process("whole").exit_code, 0);
    ASSERT_EQ(process("out").exit_code, 0);
    // As after a crash: one source half done, a file and a manifest half written.
    std::filesystem::rename(path("out/walk/manifest.json"), path("out/walk/.manifest.json.part"));
    std::filesystem::resize_file(path("out/walk/.manifest.json.part"),
                                 std::filesystem::file_size(path("out/walk/.manifest.json.part")) / 2);
    std::filesystem::remove(path("out/walk/000003.png"));
    std::filesystem::rename(path("out/walk/times.csv"), path("out/walk/.times.csv.part"));
    write_text(path("out/walk/.000003.png.12345"), "half a picture");
    write_text(path("out/walk/000009.png"), "not listed");
    write_text(path("out/walk/mine.txt"), "keep");
    const auto finished = std::filesystem::last_write_time(path("out/drive/000001.png"));
    const Outcome outcome = process("out", {"--resume", "--json", "--workers", "1", "--backend", "reference"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("out/walk: was not finished; it begins anew, as what it tells of a frame "
                                             "depends on the frames before (trust, adaptive-noise)"),
                                   Not(HasSubstr("out/drive"))));
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(summary["sources_done"], 3);
    EXPECT_EQ(summary["sources_done_before"], 2);
    EXPECT_EQ(summary["frames"], 6);
    EXPECT_EQ(std::filesystem::last_write_time(path("out/drive/000001.png")), finished);
    EXPECT_EQ(read_file(path("out/walk/mine.txt")), "keep");
    EXPECT_EQ(read_file(path("out/walk/000009.png")), "not listed");
    std::filesystem::remove(path("out/walk/mine.txt"));
    std::filesystem::remove(path("out/walk/000009.png"));
    const auto manifests_only = [](std::map<std::string, Files> all) {
        for (auto& [name, files] : all) {
            files.erase("geometry.json");  // names the back end
        }
        return all;
    };
    EXPECT_EQ(manifests_only(all_in("out")), manifests_only(all_in("whole")));

    std::filesystem::remove(path("out/drive/000001.png"));
    const Outcome again = process("out", {"--resume"});
    EXPECT_EQ(again.exit_code, 0);
    EXPECT_THAT(again.err, HasSubstr("out/drive/000001.png: is missing or empty"));
    EXPECT_EQ(verify("out").exit_code, 0);
    std::filesystem::resize_file(path("out/drive/manifest.json"),
                                 std::filesystem::file_size(path("out/drive/manifest.json")) - 10);
    const Outcome power_cut = process("out", {"--resume"});
    EXPECT_EQ(power_cut.exit_code, 0);
    EXPECT_THAT(power_cut.err,
                HasSubstr("out/drive/manifest.json: is damaged, or no manifest of disparityctl process; " +
                          path("drive") + " is processed again"));
    EXPECT_EQ(verify("out", "whole").exit_code, 0);

    const Outcome alone = run(DISPARITYCTL, {"process", path("drive"), "-o", path("alone")});
    ASSERT_EQ(alone.exit_code, 0);
    EXPECT_THAT(run(DISPARITYCTL, {"process", path("drive"), "-o", path("alone"), "--resume"}).out,
                HasSubstr("alone: 4 frames, done before\n"));
}

TEST_F(ProcessResumeTest, LossesAreToldAgainAndWhatWasLeftOutIsTriedAgain) {
    write_text(path("drive/image_0/000001.png"), "damaged");
    ASSERT_EQ(process("out", {"--keep-going"}).exit_code, 1);
    std::string text = read_file(path("out/walk/manifest.json"));
    text.replace(text.find("\"damaged\":0"), 11, "\"damaged\":2");
    write_text(path("out/walk/manifest.json"), text);
    const Outcome verified = verify("out");
    EXPECT_EQ(verified.exit_code, 0);
    EXPECT_THAT(verified.out, AllOf(HasSubstr("out/drive: not in it: 1 frame left out, 1 frame missing in between\n"),
                                    HasSubstr("out/walk: not in it: 2 frames marked as damaged\n")));
    const Outcome again = process("out", {"--keep-going", "--resume", "--json"});
    EXPECT_EQ(again.exit_code, 1);
    EXPECT_THAT(again.err, HasSubstr("out/drive: 1 frame left out before; " + path("drive") + " is processed again"));
    const auto summary = nlohmann::json::parse(again.out);
    EXPECT_EQ(summary["sources_done_before"], 2);
    EXPECT_EQ(summary["frames"], 3);
    for (const auto& source : summary["sources"]) {
        EXPECT_EQ(source["damaged_frames_skipped"], source["folder"] == path("out/walk") ? 2 : 0);
    }
}

TEST_F(ProcessResumeTest, WhatWasMadeOtherwiseIsRefused) {
    ASSERT_EQ(process("out").exit_code, 0);
    const auto before = all_in("out");
    const auto refused = [&](std::vector<std::string> more, const std::string& text) {
        more.emplace_back("--resume");
        const Outcome outcome = process("out", more);
        EXPECT_EQ(outcome.exit_code, 2) << text;
        EXPECT_THAT(outcome.err,
                    AllOf(HasSubstr(text), HasSubstr("choose another folder, or replace all with --force")));
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    };
    refused({"--median", "5"}, "out/drive: was made with parameters.match.median = 3, now 5");
    refused({"--frames", "2"}, "parameters.frames = null, now 2");
    refused({"--colour"}, "parameters.colour = null, now \"\"");
    EXPECT_EQ(all_in("out"), before);
    std::filesystem::rename(path("walk.mkv"), path("walk_of_6.mkv"));
    make_recording(path("walk.mkv"), 5, 80, 40);
    refused({}, "out/walk: was made with parameters.input.bytes = ");
    std::filesystem::rename(path("walk_of_6.mkv"), path("walk.mkv"));
    // Other pictures under the same names, of the same size.
    const std::string image = path("drive/image_0/000001.png");
    const auto time = std::filesystem::last_write_time(image);
    std::filesystem::last_write_time(image, time + std::chrono::nanoseconds(1000));
    refused({}, "out/drive: was made with other input: names, sizes or times of change of its files differ now");
    std::filesystem::last_write_time(image, time);
    std::string text = read_file(path("out/drive/manifest.json"));
    text.replace(text.find("disparityctl "), 14, "disparityctl 9");
    write_text(path("out/drive/manifest.json"), text);
    refused({}, "was made with version = \"disparityctl 9");
    EXPECT_EQ(process("out", {"--force"}).exit_code, 0);
    EXPECT_EQ(all_in("out"), before);
    EXPECT_EQ(process("out", {"--force", "--resume"}).exit_code, 2);
    EXPECT_THAT(process("out").err, HasSubstr("--resume to finish the earlier run in it, or --force to replace it"));
}

TEST_F(ProcessResumeTest, WhatWasBegunOfAnotherSourceIsRefused) {
    const auto resume = [&](const std::string& source, std::vector<std::string> more = {}) {
        more.insert(more.begin(), {"process", source, "-o", path("out"), "--disparities", "16", "--resume"});
        return run(DISPARITYCTL, more);
    };
    const std::string scene = "scene:vga?width=96&height=64&frames=2", scan = path("scan.csv");
    write_text(scan, "somebody's");
    EXPECT_EQ(resume(scene, {"--scan", scan}).exit_code, 2);
    EXPECT_EQ(read_file(scan), "somebody's");
    std::filesystem::remove(scan);
    ASSERT_EQ(resume(scene, {"--scan", scan}).exit_code, 0);
    EXPECT_THAT(resume(scene, {"--scan", scan}).out, HasSubstr("done before"));
    EXPECT_THAT(resume(scene, {"--scan", path("other.csv")}).err, HasSubstr("parameters.scan_file = "));
    write_text(scan, "somebody's");
    const Outcome changed = resume(scene, {"--scan", scan});
    EXPECT_EQ(changed.exit_code, 2);
    EXPECT_THAT(changed.err, HasSubstr("scan.csv: is not the file that was written with "));
    std::filesystem::rename(path("out/manifest.json"), path("out/.manifest.json.part"));
    const auto before = files_in(path("out"));
    const Outcome other = resume(path("walk.mkv"), {"--scan", scan});
    EXPECT_EQ(other.exit_code, 2);
    EXPECT_THAT(other.err, HasSubstr("out: was made with parameters.input.bytes = null, now "));
    EXPECT_EQ(files_in(path("out")), before);
    EXPECT_EQ(resume(scene, {"--scan", scan}).exit_code, 0);
    EXPECT_THAT(read_file(scan), Not(HasSubstr("somebody")));
}

TEST_F(ProcessResumeTest, ACalibrationThatChangedIsRefused) {
    calibration::test::Rig rig;
    const auto sensor = [&](int eye) { return path("euroc/mav0/cam" + std::to_string(eye) + "/sensor.yaml"); };
    for (const int eye : {0, 1}) {
        const std::string camera = path("euroc/mav0/cam" + std::to_string(eye));
        std::filesystem::create_directories(camera + "/data");
        write_text(camera + "/data.csv", "#timestamp [ns],filename\n1520530308199447626,a.png\n");
        images::write_png(camera + "/data/a.png", cv::Mat(rig.height, rig.width, CV_8UC1, cv::Scalar(90)));
        write_text(sensor(eye), calibration::test::euroc_sensor(rig, eye));
    }
    const std::string files = sensor(0) + ',' + sensor(1);
    const auto run_it = [&](const std::string& source, const std::string& folder, std::vector<std::string> more) {
        more.insert(more.begin(), {"process", source, "-o", path(folder), "--disparities", "16", "--resume"});
        return run(DISPARITYCTL, more);
    };
    const std::string pair = path("euroc/mav0/cam0/data/a.png") + ',' + path("euroc/mav0/cam1/data/a.png");
    ASSERT_EQ(run_it(path("euroc"), "folder", {"--hash-inputs"}).exit_code, 0);
    EXPECT_EQ(manifest("folder")["parameters"]["input"]["files"], 4);
    EXPECT_NE(manifest("folder")["parts"][0]["maps_sha256"], nullptr);
    ASSERT_EQ(run_it(pair, "given", {"--calibration", files}).exit_code, 0);
    EXPECT_THAT(run_it(pair, "given", {"--calibration", files}).out, HasSubstr("done before"));
    const Outcome unit = run_it(pair, "given", {"--calibration", files + "?unit=m"});
    EXPECT_EQ(unit.exit_code, 2);
    EXPECT_THAT(unit.err, HasSubstr("given: was made with parameters.calibration = "));
    rig.right[0] += 1;
    write_text(sensor(1), calibration::test::euroc_sensor(rig, 1));
    EXPECT_THAT(run_it(pair, "given", {"--calibration", files}).err,
                HasSubstr("given: was made with parameters.calibration = "));
    const Outcome folder = run_it(path("euroc"), "folder", {"--hash-inputs"});
    EXPECT_EQ(folder.exit_code, 2);
    EXPECT_THAT(folder.err, HasSubstr("folder: was made with "));
}

TEST_F(ProcessResumeTest, VerifyNamesWhatIsMissingChangedOrExtra) {
    ASSERT_EQ(process("out").exit_code, 0);
    ASSERT_EQ(process("other", {"--workers", "1"}).exit_code, 0);
    EXPECT_EQ(verify("out", "other").out,
              path("out") + ": 3 sources, 13 frames: all is as the manifest says, and as in " + path("other") + '\n');
    // Compressed in another way it is the same picture.
    const cv::Mat picture = images::read_image(path("out/walk/000000.png"));
    std::filesystem::remove(path("out/walk/000001.png"));
    std::filesystem::copy_file(path("out/walk/000003.pfm"), path("out/walk/000002.pfm"),
                               std::filesystem::copy_options::overwrite_existing);
    cv::Mat changed = picture.clone();
    changed.at<std::uint16_t>(3, 4) ^= 1U;
    images::write_png(path("out/drive/000000.png"), changed);
    images::write_png(path("out/drive/000001.png"), images::read_image(path("out/drive/000001.png")).reshape(0, 64));
    write_text(path("out/drive/extra.txt"), "");
    std::string geometry = read_file(path("out/drive/geometry.json"));
    geometry.replace(geometry.find("\"invalid\": -16"), 14, "\"invalid\": -17");
    write_text(path("out/drive/geometry.json"), geometry);
    std::filesystem::remove(path("out/walk/times.csv"));
    const Outcome outcome = verify("out");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.out, path("out/drive/000000.png") + ": changed\n" + path("out/drive/000001.png") + ": changed\n" +
                               path("out/drive/geometry.json") + ": changed\n" + path("out/drive/extra.txt") +
                               ": extra\n" + path("out/walk/000001.png") + ": missing\n" + path("out/walk/000002.pfm") +
                               ": changed\n" + path("out/walk/times.csv") + ": missing\n" + path("out") +
                               ": 3 sources, 13 frames: 7 problems\n");
    std::string times = read_file(path("out/drive/times.csv"));
    times.replace(times.find("000002,"), 7, "000007,");
    write_text(path("out/drive/times.csv"), times);
    EXPECT_THAT(verify("out").out, HasSubstr("out/drive/times.csv: changed: line 4\n"));
    EXPECT_EQ(verify("drive").exit_code, 2) << "no manifest";
    write_text(path("out/walk/manifest.json"), "{\"manifest\": 1, \"frames\": [{\"output\": 3}]}");
    EXPECT_THAT(verify("out").out, HasSubstr("walk/manifest.json: is damaged, or no manifest"));

    ASSERT_EQ(process("third", {"--min-distance-m", "0", "--p1", "20"}).exit_code, 0);
    const Outcome differ = verify("third", "other");
    EXPECT_EQ(differ.exit_code, 1);
    EXPECT_THAT(differ.out, HasSubstr("third/walk: parameters.match.p1 = 20, there 15\n"));
}

TEST_F(ProcessResumeTest, TheContentOfTheInputCountsWhereItIsAskedFor) {
    if (std::system("sha256sum --version >/dev/null 2>&1") != 0) {
        GTEST_SKIP() << "sha256sum is not installed";
    }
    const std::string walk = path("walk.mkv"), copy = path("copy.mkv");
    const auto hashed = [&](const std::string& source, const std::string& folder, const std::string& how) {
        return run(DISPARITYCTL, {"process", source, "-o", path(folder), "--disparities", "16", how, "--hash-inputs"});
    };
    ASSERT_EQ(hashed(walk, "one", "--resume").exit_code, 0);
    ASSERT_EQ(std::system(("sha256sum < " + walk + " | cut -c 1-64 | sha256sum > " + path("digest")).c_str()), 0);
    EXPECT_EQ(manifest("one")["input_sha256"], read_file(path("digest")).substr(0, 64));
    EXPECT_EQ(manifest("one")["parts"][0]["maps_sha256"], nullptr) << "there are none";
    std::filesystem::copy_file(walk, copy);
    ASSERT_EQ(hashed(copy, "two", "--resume").exit_code, 0);
    EXPECT_EQ(verify("one", "two").exit_code, 0);

    // Of the same size and time.
    std::string bytes = read_file(walk);
    bytes.at(bytes.rfind("Lavf")) = 'M';  // the name of who wrote it, which nobody reads
    const auto time = std::filesystem::last_write_time(walk);
    write_text(walk, bytes);
    std::filesystem::last_write_time(walk, time);
    EXPECT_EQ(run(DISPARITYCTL, {"process", walk, "-o", path("one"), "--disparities", "16", "--resume"}).exit_code, 0);
    const Outcome changed = hashed(walk, "one", "--resume");
    EXPECT_EQ(changed.exit_code, 2);
    EXPECT_THAT(changed.err, HasSubstr("one: was made with input_sha256 = "));
    ASSERT_EQ(hashed(walk, "one", "--force").exit_code, 0);
    EXPECT_THAT(verify("one", "two").out, HasSubstr("one: input_sha256 = "));

    const std::string scene = "scene:vga?width=96&height=64&frames=1";
    ASSERT_EQ(hashed(scene, "scene", "--resume").exit_code, 0);
    EXPECT_EQ(manifest("scene")["input_sha256"], nullptr) << "it is no file";
    EXPECT_EQ(manifest("scene")["parts"][0]["maps_sha256"].get<std::string>().size(), 64U);
}

TEST_F(ProcessResumeTest, TheManifestTellsThePixelsAsOtherDecodersSeeThem) {
    if (std::system("python3 --version >/dev/null 2>&1 && sha256sum --version >/dev/null 2>&1") != 0) {
        GTEST_SKIP() << "python3 and sha256sum are not installed";
    }
    ASSERT_EQ(process("out", {"--colour"}).exit_code, 0);
    const auto frame = manifest("out/walk")["frames"][2];
    EXPECT_EQ(frame["sequence"], 2);
    for (const char* name : {"000002.png", "000002_colour.png"}) {
        const std::string decoded = "python3 -B " PNG_DIGEST " " + path("out/walk/") + name + " > " + path("digest");
        ASSERT_EQ(std::system(decoded.c_str()), 0);
        EXPECT_EQ(frame["sha256"][name], read_file(path("digest")).substr(0, 64)) << name;
    }
    // Behind the header a PFM has the rows from the bottom.
    const std::string pfm = read_file(path("out/walk/000002.pfm"));
    constexpr std::size_t row = 80 * 4;
    std::string rows = "80 40 1 32\n";
    for (std::size_t y = 1; y <= 40; ++y) {
        rows += pfm.substr(pfm.size() - y * row, row);
    }
    write_text(path("rows"), rows);
    ASSERT_EQ(std::system(("sha256sum < " + path("rows") + " > " + path("digest")).c_str()), 0);
    EXPECT_EQ(frame["sha256"]["000002.pfm"], read_file(path("digest")).substr(0, 64));
}

}  // namespace
}  // namespace disparityd::test
