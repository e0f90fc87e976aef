// SPDX-License-Identifier: Apache-2.0
//
// What the real daemon refuses at start, each with one clear line and the right exit status; and what it copes with.
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using namespace std::chrono_literals;

class RefusalTest : public DaemonTest {
protected:
    /// Starts it and expects it to end with that status and one line on standard error that holds all parts.
    void expect_refusal(const std::string& config, const std::vector<std::string>& arguments, int status,
                        const std::vector<std::string>& parts) {
        const auto daemon = start(config, arguments);
        EXPECT_EQ(daemon->wait_for_exit(60s), status) << daemon->log();
        const std::string log = daemon->log();
        const auto line = log.find("disparityd: error: ");
        ASSERT_NE(line, std::string::npos) << log;
        const std::string message = log.substr(line);
        EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 1) << message;
        for (const std::string& part : parts) {
            EXPECT_THAT(message, HasSubstr(part));
        }
    }
};

TEST_F(RefusalTest, UnknownKey) {
    expect_refusal(config_text() + "speed = 3\n", {}, 2, {folder_.path() + "/d.toml:", "unknown key [record] speed"});
}

TEST_F(RefusalTest, BadDisparities) {
    for (const std::string value : {"-64", "100000", "0", "63"}) {
        expect_refusal(config_text(), {"--set", "match.disparities=" + value}, 2,
                       {"--set match.disparities=" + value, "[match] disparities", "found " + value, "multiple of 16"});
    }
}

TEST_F(RefusalTest, UnknownBackend) {
    expect_refusal(config_text(), {"--set", "match.backend=abacus"}, 2, {"abacus"});
}

TEST_F(RefusalTest, MissingSource) {
    expect_refusal(config_text(), {"--source", "/nowhere/at/all.mkv"}, 2, {"/nowhere/at/all.mkv"});
}

TEST_F(RefusalTest, CameraModeThatDoesNotExist) {
    expect_refusal(config_text("v4l2:hd960"), {}, 2, {"v4l2:hd960", "found 'hd960'", "hd720"});
}

TEST_F(RefusalTest, MasksThatDoNotFit) {
    const auto polygon = [](const std::string& corners) { return "mask.polygons=[\"" + corners + "\"]"; };
    expect_refusal(config_text(), {"--set", polygon("0,0 5,5")}, 2, {"0,0 5,5", "2 corners", "at least 3"});
    expect_refusal(config_text(), {"--check", "--set", polygon("0,0 160,5 3,8")}, 2, {"160,5", "0,0 to 159,87"});
    expect_refusal(config_text(), {"--set", "mask.image=/nowhere/mask.png"}, 2, {"/nowhere/mask.png"});
    const std::string small = folder_.write("small.pgm", "P5 2 2 255\n" + std::string(4, '\xff'));
    expect_refusal(config_text(), {"--check", "--set", "mask.image=" + small}, 2, {small, "2 x 2", "160 x 88"});
    const std::string coloured = folder_.write("colour.ppm", "P6 1 1 255\n" + std::string(3, '\xff'));
    expect_refusal(config_text(), {"--set", "mask.image=" + coloured}, 2, {coloured, "3 channels", "one of 8 bits"});
}

TEST_F(RefusalTest, LimitsOfDistanceWithNothingBetweenThem) {
    expect_refusal(config_text(), {"--set", "output.min_distance_m=3", "--set", "output.max_distance_m=3"}, 2,
                   {"--set output.max_distance_m=3", "[output] max_distance_m", "more than"});
}

TEST_F(RefusalTest, CalibrationThatIsAWebPage) {
    const std::string page = folder_.write("SN1234.conf", "<!DOCTYPE html>\n<html><body>Not found</body></html>\n");
    expect_refusal(config_text(), {"--set", "source.calibration=" + page}, 2, {page});
}

TEST_F(RefusalTest, RegionOutsideTheImage) {
    expect_refusal(config_text(), {"--set", "rectify.region=[100, 0, 100, 50]"}, 2, {"100"});
}

TEST_F(RefusalTest, ImagesAsCapturedOfAnotherSize) {
    expect_refusal(config_text(), {"--set", "rectify.raw=true"}, 2, {"rectify.raw", "160x88", "320x176"});
}

TEST_F(RefusalTest, CommandLine) {
    expect_refusal(config_text(), {"--sauce", "x"}, 2, {"command line", "--sauce", "--help"});
    expect_refusal(config_text(), {"--set", "disparities=32"}, 2, {"--set disparities=32", "section.key=value"});
}

TEST_F(RefusalTest, MissingConfigurationFile) {
    DaemonProcess daemon(folder_, {"--config", "/nowhere.toml"});
    EXPECT_EQ(daemon.wait_for_exit(), 2);
    EXPECT_THAT(daemon.log(),
                StartsWith("disparityd: error: configuration /nowhere.toml: no such file; check the path"));
}

TEST_F(RefusalTest, OpenAddressWithoutTheWordInsecure) {
    expect_refusal(config_text(), {"--set", "socket.tcp=0.0.0.0:0"}, 2, {"[socket] tcp", "0.0.0.0:0", "insecure"});
    const auto daemon = start_ready(config_text(), {"--set", "socket.tcp=0.0.0.0:0", "--set", "socket.insecure=true"});
    EXPECT_THAT(daemon->address("tcp:"), StartsWith("tcp:0.0.0.0:"));
}

TEST_F(RefusalTest, PortInUse) {
    const auto first = start_ready(config_text());
    const std::string address = first->address("tcp:").substr(4);
    expect_refusal(config_text(), {"--set", "socket.tcp=" + address, "--set", "socket.unix=", "--name", "other"}, 1,
                   {address, "in use", "[socket] tcp"});
    expect_refusal(config_text(), {"--name", "other"}, 1, {folder_.path() + "/d.sock", "in use", "[socket] unix"});
}

TEST_F(RefusalTest, SharedMemoryOfALivingDaemon) {
    const auto first = start_ready(config_text());
    expect_refusal(config_text(), {"--set", "socket.unix="}, 1, {"disparityd." + shared_memory_name()});
    WireClient client = subscriber(first->address("tcp:"), {v1::LEFT});
    EXPECT_TRUE(client.receive_frame());
}

TEST_F(RefusalTest, LeftOversOfAKilledDaemonAreReplaced) {
    {
        const auto killed = start_ready(config_text());
        killed->send_signal(SIGKILL);
        EXPECT_EQ(killed->wait_for_exit(), 128 + SIGKILL);
    }
    const auto daemon = start_ready(config_text());
    WireClient client = subscriber(daemon->address("unix:"), {v1::LEFT});
    EXPECT_TRUE(client.receive_frame());
    EXPECT_THAT(daemon->log(), HasSubstr("left over"));
    EXPECT_THAT(daemon->log(), HasSubstr("disparityd." + shared_memory_name()));
}

TEST_F(RefusalTest, CheckOnlyChecks) {
    const auto good = start(config_text(), {"--check"});
    EXPECT_EQ(good->wait_for_exit(), 0);
    EXPECT_THAT(good->output(),
                AllOf(StartsWith("disparityd: note: nothing nearer than "), HasSubstr(" m needs "),
                      HasSubstr("at 5 m a step of 1/16 px is "), HasSubstr("ms a frame of the source here\n"),
                      HasSubstr("memory at most: "), EndsWith("disparityd: the configuration is valid\n")));
    const auto slow = start(config_text("scene:vga@100?width=320&height=176&loop=8", 640, 352),
                            {"--check", "--set", "match.backend=reference", "--set", "match.method=sgm"});
    EXPECT_EQ(slow->wait_for_exit(), 0);
    EXPECT_THAT(slow->output(), HasSubstr("matching is slower than the source: 100.0 frames/s come, "));
    // Neither a camera that is not there nor another daemon at the same addresses is the configuration's fault.
    const auto other = start_ready(config_text());
    EXPECT_EQ(start(config_text(), {"--check", "--source", "v4l2:hd720@30?serial=1"})->wait_for_exit(), 0);
    expect_refusal(config_text() + "x = 1\n", {"--check"}, 2, {"[record] x"});
    expect_refusal(config_text(), {"--check", "--set", "match.backend=gpu"}, 2, {"\"gpu\"", "auto", "reference"});
    expect_refusal(config_text(), {"--check", "--source", "absent.mkv"}, 2, {"absent.mkv", "cannot open"});
    expect_refusal(config_text(), {"--check", "--source", "/dev/null"}, 2,
                   {"/dev/null", "a device", "disparityctl sources"});
    expect_refusal(config_text(), {"--check", "--source", "scene:uhd@30"}, 2, {"scene:uhd@30", "vga"});
    expect_refusal(config_text(), {"--check", "--set", "rectify.region=[100, 0, 100, 50]"}, 2, {"100"});
}

TEST_F(RefusalTest, HelpAndVersion) {
    DaemonProcess help(folder_, {"--help"});
    EXPECT_EQ(help.wait_for_exit(), 0);
    for (const char* part : {"--config", "--set", "--check", "Examples:", "SIGHUP", "Exit status"}) {
        EXPECT_THAT(help.output(), HasSubstr(part));
    }
    DaemonProcess version(folder_, {"--version"});
    EXPECT_EQ(version.wait_for_exit(), 0);
    EXPECT_THAT(version.output(), StartsWith("disparityd "));
}

// Its backlog is full, so a connection would wait for it for ever.
TEST_F(RefusalTest, ASocketThatAcceptsNobodyIsRefusedToo) {
    const std::string path = folder_.path() + "/d.sock";
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    std::strncpy(name.sun_path, path.c_str(), sizeof name.sun_path - 1);
    const auto* address = reinterpret_cast<const sockaddr*>(&name);
    const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    ASSERT_EQ(bind(listener, address, sizeof name), 0);
    ASSERT_EQ(listen(listener, 0), 0);
    std::vector<int> waiting;
    do {
        waiting.push_back(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    } while (connect(waiting.back(), address, sizeof name) == 0);
    EXPECT_EQ(errno, EAGAIN);
    expect_refusal(config_text(), {}, 1, {"cannot serve at unix:" + path, "Address already in use", "[socket] unix"});
    for (const int end : waiting) {
        close(end);
    }
    close(listener);
}

}  // namespace
}  // namespace disparityd::test
