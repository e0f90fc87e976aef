// SPDX-License-Identifier: Apache-2.0
//
// The daemon is killed and started again under programs that read it: they go on.
#include <csignal>
#include <fstream>
#include <functional>
#include <sstream>

#include <gmock/gmock.h>

#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using Line = std::function<bool(const std::string& line)>;

class RestartTest : public DaemonTest {
protected:
    std::string unix_address() const { return "unix:" + folder_.path() + "/d.sock"; }

    /// Runs a program of the examples while a daemon is killed and another one is started. `of_the_first` and
    /// `of_the_second` know frames of these daemons by what the program prints.
    void expect_survival(const std::string& program, const std::vector<std::string>& arguments,
                         const Line& of_the_first, const Line& of_the_second) {
        std::signal(SIGINT, SIG_DFL);  // a shell's background job inherits that it is ignored
        auto daemon = start_ready(config_text("scene:vga@100?width=320&height=176&loop=8"));
        DaemonProcess reader(folder_, arguments, {{"PYTHONPATH", DISPARITYD_PYTHON_PATH}}, program);
        EXPECT_TRUE(reader.wait_for_line(of_the_first)) << reader.log() << daemon->log();
        daemon->send_signal(SIGKILL);
        EXPECT_EQ(daemon->wait_for_exit(), 128 + SIGKILL);
        daemon = start_ready(config_text("scene:vga@4?width=320&height=176&loop=8", 96, 64));
        EXPECT_TRUE(reader.wait_for_line(of_the_second)) << reader.log() << daemon->log();
        EXPECT_EQ(reader.wait_for_exit(std::chrono::milliseconds(0)), std::nullopt) << reader.log();
        daemon->send_signal(SIGKILL);
        EXPECT_EQ(daemon->wait_for_exit(), 128 + SIGKILL);
        reader.send_signal(SIGINT);
        EXPECT_TRUE(reader.wait_for_exit()) << "Ctrl-C while there is no daemon";
    }

    /// Of the programs that print "frame N": the first daemon gets far in a second, the other one would need half a
    /// minute.
    void expect_nearest_survives(const std::string& program, const std::vector<std::string>& arguments) {
        const auto number = [](const std::string& line) {
            return line.starts_with("frame ") ? std::stoul(line.substr(6)) : 0;
        };
        expect_survival(
            program, arguments, [&](const std::string& line) { return number(line) > 120; },
            [&](const std::string& line) { return line.starts_with("frame ") && number(line) < 120; });
    }

    /// Skips where there is no Python or it lacks modules.
    static bool python_lacks(const std::string& module) {
        const std::string python = DISPARITYD_PYTHON;
        return python.empty() || std::system((python + " -c 'import " + module + "' 2> /dev/null").c_str()) != 0;
    }
};

#define SKIP_WITHOUT_PYTHON()                                                                   \
    if (python_lacks("numpy, google.protobuf")) {                                               \
        GTEST_SKIP() << "no Python for this machine's programs, or no numpy or protobuf in it"; \
    }

TEST_F(RestartTest, CppExampleOverSharedMemory) {
    expect_nearest_survives(DISPARITYD_NEAREST_CPP, {shared_memory_name()});
}

TEST_F(RestartTest, CExampleOverASocket) {
    expect_nearest_survives(DISPARITYD_NEAREST_C, {unix_address()});
}

TEST_F(RestartTest, PythonExampleOverASocket) {
    SKIP_WITHOUT_PYTHON();
    expect_nearest_survives(DISPARITYD_PYTHON, {"-B", DISPARITYD_NEAREST_PY, unix_address()});
}

TEST_F(RestartTest, PythonExampleOverSharedMemory) {
    SKIP_WITHOUT_PYTHON();
    if (!DISPARITYD_PYTHON_LIBRARY) {
        GTEST_SKIP() << "an instrumented library cannot be loaded into a program that is not";
    }
    expect_nearest_survives(DISPARITYD_PYTHON, {"-B", DISPARITYD_NEAREST_PY, shared_memory_name()});
}

TEST_F(RestartTest, ReadmesCppLoop) {
    expect_survival(
        DISPARITYD_README_LOOP, {shared_memory_name()},
        [](const std::string& line) { return line == "left 160 x 88, points 160 x 88"; },
        [](const std::string& line) { return line == "left 96 x 64, points 96 x 64"; });
}

TEST_F(RestartTest, ReadmesPythonLoop) {
    SKIP_WITHOUT_PYTHON();
    std::ifstream file(DISPARITYD_README);
    std::stringstream text;
    text << file.rdbuf();
    std::string code = text.str();
    const std::string begin = "```python\nimport disparity\n";
    ASSERT_NE(code.find(begin), std::string::npos);
    code = code.substr(code.find(begin) + std::string("```python\n").size());
    code = code.substr(0, code.find("```"));
    const std::string address = "default";
    ASSERT_NE(code.find(address), std::string::npos);
    code.replace(code.find(address), address.size(), unix_address());
    expect_survival(
        DISPARITYD_PYTHON, {"-B", "-u", folder_.write("readme.py", code)},
        [](const std::string& line) { return line.ends_with("ms (88, 160)"); },
        [](const std::string& line) { return line.ends_with("ms (64, 96)"); });
}

}  // namespace
}  // namespace disparityd::test
