// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <gmock/gmock.h>

#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"
#include "tools/images/image_file.h"

namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

/// Each refusal: exit code 2 and one line that names the program and what is wrong.
void expect_refused(const Outcome& outcome, const testing::Matcher<std::string>& says) {
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, StartsWith("disparityctl: error: "));
    EXPECT_THAT(outcome.err, says);
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.out, "");
}

class BadInputTest : public FolderTest {
protected:
    Outcome process(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"process", "-o", path("out")});
        Outcome outcome = run(DISPARITYCTL, arguments);
        EXPECT_FALSE(std::filesystem::exists(path("out"))) << "nothing is made of input that is refused";
        return outcome;
    }
};

TEST_F(BadInputTest, SubCommandThatThereIsNot) {
    const auto names_all = AllOf(HasSubstr("status, watch, scan"), HasSubstr("certificates; see disparityctl --help"));
    expect_refused(run(DISPARITYCTL, {"snapshoot", "-o", "now.png"}), AllOf(HasSubstr("'snapshoot'"), names_all));
    expect_refused(run(DISPARITYCTL, {}), AllOf(HasSubstr("found no sub-command"), names_all));
    expect_refused(run(DISPARITYCTL, {"--snapshot"}), HasSubstr("--snapshot; see disparityctl --help"));
}

TEST_F(BadInputTest, FolderOfUnequalSizes) {
    make_kitti_folder(path("in"), 2, 64, 32);
    images::write_png(path("in/image_1/000001.png"), cv::Mat(32, 60, CV_8UC1, cv::Scalar(7)));
    expect_refused(process({path("in")}), AllOf(HasSubstr("000001.png"), HasSubstr("60"), HasSubstr("64")));
}

TEST_F(BadInputTest, YuyvWidthThatIsNoMultipleOf4) {
    constexpr std::size_t width = 66, height = 4;
    write_text(path("odd.y4m"), "YUV4MPEG2 W66 H4 F15:1 Ip A1:1 C422\nFRAME\n" + std::string(2 * width * height, 'x'));
    expect_refused(process({path("odd.y4m")}),
                   AllOf(HasSubstr("odd.y4m"), HasSubstr("66"), HasSubstr("multiple of 4")));
}

TEST_F(BadInputTest, CalibrationOfAnotherResolution) {
    make_kitti_folder(path("in"), 1, 64, 32);
    write_text(path("other.conf"),
               "[LEFT_CAM_VGA]\nfx=350\nfy=350\ncx=336\ncy=188\nk1=0\nk2=0\n"
               "[RIGHT_CAM_VGA]\nfx=350\nfy=350\ncx=336\ncy=188\nk1=0\nk2=0\n"
               "[STEREO]\nBaseline=120\nTY=0\nTZ=0\nCV_VGA=0\nRX_VGA=0\nRZ_VGA=0\n");
    expect_refused(process({path("in"), "--calibration", path("other.conf")}),
                   AllOf(HasSubstr("other.conf"), HasSubstr("64")));
}

TEST_F(BadInputTest, CalibrationThatIsAnHtmlPage) {
    make_kitti_folder(path("in"), 1, 64, 32);
    write_text(path("SN1.conf"), "<!DOCTYPE html>\n<html><body>Not found</body></html>\n");
    expect_refused(process({path("in"), "--calibration", path("SN1.conf")}),
                   AllOf(HasSubstr("SN1.conf"), HasSubstr("web page")));
}

TEST_F(BadInputTest, NegativeHugeOrUnevenDisparities) {
    make_kitti_folder(path("in"), 1, 64, 32);
    for (const char* count : {"-16", "0", "512", "99999999999999999999", "many", "64.5"}) {
        expect_refused(process({path("in"), "--disparities", count}),
                       AllOf(HasSubstr("--disparities"), HasSubstr(count), HasSubstr("256")));
    }
    expect_refused(process({path("in"), "--disparities", "40"}), AllOf(HasSubstr("40"), HasSubstr("multiple of 16")));
    expect_refused(process({path("in"), "--d-min", "-300"}), AllOf(HasSubstr("--d-min"), HasSubstr("-256")));
}

TEST_F(BadInputTest, OptionsThatDoNotExist) {
    make_kitti_folder(path("in"), 1, 64, 32);
    expect_refused(process({path("in"), "--method", "smg"}), AllOf(HasSubstr("smg"), HasSubstr("census")));
    expect_refused(process({path("in"), "--backend", "abacus"}), AllOf(HasSubstr("abacus"), HasSubstr("cpu")));
    expect_refused(process({path("in"), "--p1", "90", "--p2", "50"}), HasSubstr("p1"));
    expect_refused(process({path("in"), "--method", "sad", "--p1", "4"}),
                   HasSubstr("--p1: only the method sgm uses it, found: sad"));
    expect_refused(process({path("in"), "--method", "census", "--no-adaptive-p2"}), HasSubstr("--adaptive-p2"));
    expect_refused(process({path("in"), "--colour-range", "frame"}), HasSubstr("--colour"));
    expect_refused(process({path("in"), "--size", "640"}), AllOf(HasSubstr("--size"), HasSubstr("640x360")));
    expect_refused(process({path("in"), "--size", "0x0"}), HasSubstr("--size"));
    expect_refused(process({path("in"), "--region", "0,0,64"}), HasSubstr("--region"));
    expect_refused(process({path("in"), "--region", "0,0,0,0"}), HasSubstr("--region"));
    expect_refused(process({path("in"), "--region", "60,0,64,32"}), HasSubstr("region"));
    expect_refused(process({path("in"), "--sizzle"}), HasSubstr("--sizzle"));
    expect_refused(run(DISPARITYCTL, {"proces"}), HasSubstr("proces"));
    expect_refused(run(DISPARITYCTL, {}), HasSubstr("--help"));
}

TEST_F(BadInputTest, OptionsOfScanThatAreNotAllowed) {
    const auto scan = [this](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"scan", "--socket", "unix:" + path("nobody.sock")});
        return run(DISPARITYCTL, arguments);
    };
    expect_refused(scan({"--count", "0"}), AllOf(HasSubstr("--count"), HasSubstr("found '0'")));
    expect_refused(scan({"--rate", "0"}), AllOf(HasSubstr("--rate"), HasSubstr("from 0.01 to 1000")));
    expect_refused(scan({"--rate", "often"}), AllOf(HasSubstr("--rate"), HasSubstr("often")));
    expect_refused(scan({"--range", "66"}), AllOf(HasSubstr("--range"), HasSubstr("from 0.5 to 65")));
    expect_refused(scan({"--json", "--plot"}), AllOf(HasSubstr("--json"), HasSubstr("--plot")));
    expect_refused(scan({"--json", "--line"}), AllOf(HasSubstr("--json"), HasSubstr("--line")));
    expect_refused(scan({"--line", "--plot"}), AllOf(HasSubstr("--line"), HasSubstr("--plot")));
    expect_refused(scan({"--json", "--ascii"}), AllOf(HasSubstr("--json"), HasSubstr("--ascii")));
    expect_refused(scan({"--line", "--range", "5"}), AllOf(HasSubstr("--line"), HasSubstr("--range")));
    expect_refused(scan({"--sizzle"}), HasSubstr("--sizzle"));
}

TEST_F(BadInputTest, SourceThatIsNotThere) {
    expect_refused(process({path("nothing.mkv")}), HasSubstr("nothing.mkv"));
    std::filesystem::create_directory(path("empty"));
    expect_refused(process({path("empty")}), HasSubstr("empty"));
    write_text(path("text.mkv"), "this is no video");
    expect_refused(process({path("text.mkv")}), HasSubstr("text.mkv"));
}

TEST_F(BadInputTest, NoDaemonIsExitCode1) {
    for (const char* command : {"status", "watch", "scan", "snapshot", "record"}) {
        std::vector<std::string> arguments{command, "--socket", "unix:" + path("nobody.sock")};
        if (std::string(command) == "snapshot") {
            arguments.insert(arguments.end(), {"-o", path("x.png")});
        } else if (std::string(command) == "record") {
            arguments.push_back("x.mkv");
        }
        const Outcome outcome = run(DISPARITYCTL, arguments);
        EXPECT_EQ(outcome.exit_code, 1) << command;
        EXPECT_EQ(outcome.err,
                  "disparityctl: error: unix:" + path("nobody.sock") +
                      ": cannot connect: No such file or directory: is disparityd running, with this address?\n");
    }
    const Outcome by_name = run(DISPARITYCTL, {"watch", "--name", "nobody-has-this-name"});
    EXPECT_EQ(by_name.exit_code, 1);
    EXPECT_THAT(by_name.err, HasSubstr("nobody-has-this-name"));
    expect_refused(run(DISPARITYCTL, {"status", "--socket", "somewhere"}), HasSubstr("somewhere"));
}

TEST_F(BadInputTest, VersionsAreTold) {
    for (const auto& [program, name] :
         {std::pair(DISPARITYCTL, "disparityctl"), std::pair(DISPARITY_EVAL, "disparity-eval")}) {
        const Outcome outcome = run(program, {"--version"});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_THAT(outcome.out, testing::MatchesRegex(std::string(name) +
                                                       " [0-9]+\\.[0-9]+\\.[0-9]+( \\(commit [0-9a-f]{12,}\\))?\n"));
    }
}

TEST_F(BadInputTest, EveryHelpHasAnExample) {
    for (const char* command : {"status", "watch", "scan", "snapshot", "record", "process", "camera", "sensors",
                                "trace", "sources", "certificates"}) {
        const Outcome outcome = run(DISPARITYCTL, {command, "--help"});
        EXPECT_EQ(outcome.exit_code, 0);
        EXPECT_THAT(outcome.out, HasSubstr(std::string("disparityctl ") + command)) << "an example";
    }
    EXPECT_EQ(run(DISPARITY_EVAL, {"--help"}).exit_code, 0);
}

}  // namespace
}  // namespace disparityd::test
