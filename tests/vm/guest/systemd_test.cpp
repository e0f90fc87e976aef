// SPDX-License-Identifier: Apache-2.0
//
// The unit and the udev rules as they are installed, under Debian's systemd and udev, with a camera that goes and
// comes.

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"
#include "tests/vm/guest/camera_process.h"
#include "tests/vm/guest/waiting.h"

namespace vm_guest {
namespace {

/// What a program said and how it ended.
struct Said {
    int status = -1;
    std::string text;  ///< standard output and error
};

/// Runs a program of /usr/bin with the system's own libraries and waits for its end.
Said run_system_program(std::vector<std::string> arguments) {
    const std::string program = "/usr/bin/" + arguments.front();
    std::vector<char*> pointers;
    for (std::string& each : arguments) {
        pointers.push_back(each.data());
    }
    pointers.push_back(nullptr);
    std::array<int, 2> pipe{};
    if (::pipe2(pipe.data(), O_CLOEXEC) != 0) {
        throw std::runtime_error("no pipe");
    }
    const pid_t process = ::fork();
    if (process == 0) {
        ::unsetenv("LD_LIBRARY_PATH");
        ::dup2(pipe[1], STDOUT_FILENO);
        ::dup2(pipe[1], STDERR_FILENO);
        ::execv(program.c_str(), pointers.data());
        ::_exit(127);
    }
    ::close(pipe[1]);
    Said said;
    std::array<char, 4096> part{};
    for (ssize_t got = 0; (got = ::read(pipe[0], part.data(), part.size())) > 0;) {
        said.text.append(part.data(), static_cast<std::size_t>(got));
    }
    ::close(pipe[0]);
    int status = 0;
    ::waitpid(process, &status, 0);
    said.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return said;
}

/// A unit of the guest's systemd.
class SystemUnit {
public:
    explicit SystemUnit(std::string name) : name_(std::move(name)) {}

    /// systemctl VERB UNIT
    Said order(const std::string& verb) const { return run_system_program({"systemctl", verb, name_}); }

    /// Such as "ActiveState", "StatusText", "MainPID".
    std::string property(const std::string& property) const;
    int main_process() const { return std::stoi(property("MainPID")); }

    /// Whether its status line comes to hold the text.
    bool comes_to_say(const std::string& text) const;

    /// What a failed test shows.
    std::string journal() const {
        return run_system_program({"journalctl", "--no-pager", "-n", "40", "-u", name_}).text;
    }

private:
    std::string name_;
};

std::string SystemUnit::property(const std::string& property) const {
    std::string text = run_system_program({"systemctl", "show", "--value", "-p", property, name_}).text;
    while (!text.empty() && text.back() == '\n') {
        text.pop_back();
    }
    return text;
}

bool SystemUnit::comes_to_say(const std::string& text) const {
    return eventually([&] { return property("StatusText").find(text) != std::string::npos; });
}

/// A program in the background that prints a line for each frame that it reads; ended with the object.
class ReadingProgram {
public:
    /// The first argument is the program's path. Programs of the guest's own /usr find their libraries themselves.
    explicit ReadingProgram(std::vector<std::string> arguments);
    ~ReadingProgram();
    ReadingProgram(const ReadingProgram&) = delete;
    ReadingProgram& operator=(const ReadingProgram&) = delete;

    /// Whether two more lines come from now on: the first may be of a frame that was read before.
    bool goes_on() const;

    /// All that it has printed, errors too.
    std::string said() const;

private:
    std::string file_;
    pid_t process_ = -1;
};

ReadingProgram::ReadingProgram(std::vector<std::string> arguments) {
    static std::atomic<int> programs{0};
    file_ = "/tmp/said" + std::to_string(++programs);
    std::vector<char*> pointers;
    for (std::string& each : arguments) {
        pointers.push_back(each.data());
    }
    pointers.push_back(nullptr);
    process_ = ::fork();
    if (process_ == 0) {
        if (arguments.front().starts_with("/usr/")) {
            ::unsetenv("LD_LIBRARY_PATH");
        }
        const int out = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        ::dup2(out, STDOUT_FILENO);
        ::dup2(out, STDERR_FILENO);
        ::execv(pointers.front(), pointers.data());
        ::_exit(127);
    }
}

ReadingProgram::~ReadingProgram() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
}

bool ReadingProgram::goes_on() const {
    const auto lines = [this] {
        const std::string text = said();
        return std::count(text.begin(), text.end(), '\n');
    };
    const auto before = lines();
    // An interpreter that reads its modules takes long under emulation.
    return eventually([&] { return lines() >= before + 2; }, 4 * patience);
}

std::string ReadingProgram::said() const {
    std::ostringstream text;
    text << std::ifstream(file_).rdbuf();
    return text.str();
}

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* address = "unix:/run/disparityd/disparityd.sock";

std::int64_t monotonic_ns() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

/// Where the unit looks for it: that of the packages, where they are installed, or of the build.
std::string config_file() {
    const std::string of_packages = "/etc/disparityd/disparityd.toml";
    return fs::exists(of_packages) ? of_packages : DISPARITYD_CONFIG_FILE;
}

/// The unit's configuration, with this many candidates of disparity.
void configure(int disparities) {
    fs::create_directories(fs::path(config_file()).parent_path());
    std::ofstream(config_file()) << "[source]\nuri = \"v4l2:vga@15\"\nallow_unrectified = true\n"
                                    "stall_ms = 15000\n[match]\nmethod = \"sad\"\ndepth = false\ndisparities = "
                                 << disparities << '\n';
}

/// Mode and group, such as "0660 video".
std::string access_to(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) {
        return "missing";
    }
    char mode[8];
    std::snprintf(mode, sizeof mode, "%04o", status.st_mode & 07777U);
    const group* const owner = ::getgrgid(status.st_gid);
    return std::string(mode) + ' ' + (owner != nullptr ? owner->gr_name : "nobody's");
}

std::string content(const std::string& path) {
    std::string text;
    std::getline(std::ifstream(path) >> std::ws, text);
    return text;
}

/// One camera and the unit for all tests, in the order in which they stand here.
class Systemd : public testing::Test {
protected:
    static void SetUpTestSuite() {
        std::printf("seconds from the kernel's start to this test: %.1f\n", static_cast<double>(monotonic_ns()) * 1e-9);
        configure(16);
        camera_ = std::make_unique<CameraProcess>();
    }
    static void TearDownTestSuite() { camera_.reset(); }

    void TearDown() override {
        if (HasFailure()) {
            std::printf("%s\n", unit_.journal().c_str());
        }
    }

    /// A client that is connected for the whole of a test.
    static disparity::SocketClient connected() {
        disparity::SocketClient client(address, "test of the unit", patience);
        disparity::Subscription subscription;
        subscription.products = {disparity::Product::left};
        client.subscribe(subscription);
        return client;
    }

    /// Whether a frame comes that was captured after this call.
    static bool new_frame(disparity::SocketClient& client) {
        const std::int64_t begin = monotonic_ns();
        disparity::Frame frame;
        return eventually([&] {
            return client.read(frame, milliseconds(100)) == disparity::ReadResult::frame && frame.monotonic_ns > begin;
        });
    }

    /// Starts the instance "left" on a rendered scene; `match` has more lines of its section [match].
    void start_left(const std::string& uri, const std::string& match = "") const {
        std::ofstream(fs::path(config_file()).replace_filename("left.toml"))
            << "[source]\nuri = \"" << uri << "\"\n[match]\nmethod = \"sad\"\n"
            << match << "disparities = 16\n[socket]\ntcp = \"\"\n";
        const Said started = left_.order("start");
        ASSERT_EQ(started.status, 0) << started.text << left_.journal();
    }

    static std::unique_ptr<CameraProcess> camera_;
    const SystemUnit unit_{"disparityd.service"};
    const SystemUnit left_{"disparityd@left.service"};
};

std::unique_ptr<CameraProcess> Systemd::camera_;

TEST_F(Systemd, UdevGivesTheCameraToItsGroupAndKeepsItAwake) {
    const std::string node = camera_->node().path;
    EXPECT_TRUE(eventually([&] { return access_to(node) == "0660 video"; })) << access_to(node);
    const std::string device = usb_node(camera_->node());
    EXPECT_TRUE(eventually([&] { return access_to(device) == "0660 video"; })) << access_to(device);
    EXPECT_TRUE(eventually([&] { return content(camera_->node().usb_path + "/power/control") == "on"; }));
    // The name that stays the same, which docs/operations.md tells users of.
    EXPECT_TRUE(eventually([&] {
        std::error_code none;
        return std::any_of(fs::directory_iterator("/dev/v4l/by-path", none), fs::directory_iterator(),
                           [&](const fs::path& link) { return fs::canonical(link, none) == node; });
    }));
}

TEST_F(Systemd, TheUnitIsReadyAndSaysHowItStands) {
    // Where the packages are installed, the boot has started it, with their configuration.
    const bool at_boot = fs::exists("/etc/systemd/system/default.target.wants/disparityd.service");
    EXPECT_TRUE(!at_boot || eventually([&] { return unit_.property("ActiveState") == "active"; })) << unit_.journal();
    const Said started = unit_.order(at_boot ? "reload" : "start");
    ASSERT_EQ(started.status, 0) << started.text;
    EXPECT_TRUE(eventually([&] { return unit_.property("ActiveState") == "active"; }));
    EXPECT_TRUE(unit_.comes_to_say("running, ")) << unit_.property("StatusText");
    EXPECT_EQ(content("/proc/" + std::to_string(unit_.main_process()) + "/comm"), "disparityd");
    EXPECT_EQ(access_to("/run/disparityd/disparityd.sock"), "0660 disparityd");
    auto client = connected();
    EXPECT_TRUE(new_frame(client));
}

TEST_F(Systemd, ACameraThatGoesAndComesIsSeenAtOnce) {
    auto client = connected();
    const int process = unit_.main_process();
    std::vector<double> seconds_to_a_frame;
    for (int i = 0; i < 5; ++i) {
        camera_->unplug();
        // Before that it may say that the camera has stopped sending frames.
        ASSERT_TRUE(unit_.comes_to_say("plug it in")) << unit_.property("StatusText");
        EXPECT_THAT(unit_.property("StatusText"), HasSubstr("waiting"));
        camera_->plug();
        const std::int64_t back = monotonic_ns();
        ASSERT_TRUE(new_frame(client));
        seconds_to_a_frame.push_back(static_cast<double>(monotonic_ns() - back) * 1e-9);
        ASSERT_TRUE(unit_.comes_to_say("running, "));
    }
    EXPECT_EQ(unit_.main_process(), process);
    // A host with other work may hold up some of them.
    std::sort(seconds_to_a_frame.begin(), seconds_to_a_frame.end());
    std::printf("seconds to the first frame: median %.2f, most %.2f\n", seconds_to_a_frame[2],
                seconds_to_a_frame.back());
    EXPECT_LT(seconds_to_a_frame[2], 2.0);
}

TEST_F(Systemd, ReloadTakesTheNewConfigurationAndKeepsClients) {
    auto client = connected();
    const int process = unit_.main_process();
    configure(32);
    const Said reloaded = unit_.order("reload");
    EXPECT_EQ(reloaded.status, 0) << reloaded.text;
    EXPECT_TRUE(eventually([&] {
        disparityd::v1::Status status;
        return status.ParseFromString(client.status(patience)) && status.geometry().disparities() == 32;
    }));
    EXPECT_TRUE(new_frame(client));
    EXPECT_EQ(unit_.main_process(), process);
}

TEST_F(Systemd, AnInstanceHasWhatIsServedUnderItsNameBesideTheUnit) {
    ASSERT_NO_FATAL_FAILURE(start_left("scene:vga@2?loop=1", "depth = false\n"));
    EXPECT_TRUE(left_.comes_to_say("running, ")) << left_.property("StatusText");
    EXPECT_EQ(access_to("/run/disparityd/disparityd-left.sock"), "0660 disparityd");
    EXPECT_EQ(access_to("/dev/shm/disparityd.left"), "0640 disparityd");
    EXPECT_EQ(access_to("/var/lib/disparityd/left"), "0750 disparityd");
    disparity::SharedMemoryReader reader("left");
    disparity::Frame frame;
    EXPECT_EQ(reader.read(frame, patience), disparity::ReadResult::frame);

    const Said stopped = left_.order("stop");
    EXPECT_EQ(stopped.status, 0) << stopped.text;
    EXPECT_FALSE(fs::exists("/run/disparityd/disparityd-left.sock"));
    EXPECT_FALSE(fs::exists("/dev/shm/disparityd.left"));
    // The other daemon has the same user and the same folder.
    EXPECT_TRUE(fs::exists("/dev/shm/disparityd.default"));
    auto client = connected();
    EXPECT_TRUE(new_frame(client));
}

TEST_F(Systemd, TheWatchdogEndsADaemonThatStandsStillAndStartsAnother) {
    const int process = unit_.main_process();
    ASSERT_EQ(::kill(process, SIGSTOP), 0);
    EXPECT_TRUE(eventually([&] { return unit_.property("NRestarts") == "1" && unit_.comes_to_say("running, "); }));
    EXPECT_NE(unit_.main_process(), process);
    EXPECT_TRUE(eventually([&] { return unit_.journal().find("Watchdog timeout") != std::string::npos; }))
        << unit_.journal();
    auto client = connected();
    EXPECT_TRUE(new_frame(client));
}

TEST_F(Systemd, ClientsReturnToADaemonThatHasCrashed) {
    ASSERT_NO_FATAL_FAILURE(start_left("scene:vga@2?width=320&height=176&loop=1"));
    const ReadingProgram in_cpp({"/vm/daemon_readme_loop", "left"});
    EXPECT_TRUE(in_cpp.goes_on()) << in_cpp.said();
    // Where the packages are installed, Python is there too.
    const std::string script = "/vm/readme_loop.py";
    std::optional<ReadingProgram> in_python;
    if (fs::exists(script)) {
        in_python.emplace(std::vector<std::string>{"/usr/bin/python3", "-B", "-u", script});
        EXPECT_TRUE(in_python->goes_on()) << in_python->said();
    }

    const int process = left_.main_process();
    ASSERT_EQ(::kill(process, SIGSEGV), 0);
    EXPECT_TRUE(eventually([&] { return left_.property("NRestarts") == "1"; }, 4 * patience));  // a core may be written
    EXPECT_TRUE(left_.comes_to_say("running, ")) << left_.journal();
    EXPECT_NE(left_.main_process(), process);
    EXPECT_TRUE(in_cpp.goes_on()) << in_cpp.said();
    EXPECT_TRUE(!in_python || in_python->goes_on()) << in_python->said();
    EXPECT_EQ(left_.order("stop").status, 0);
}

TEST_F(Systemd, TheDropInForRealTimeSchedulesAllThreadsBeforeOthers) {
    const fs::path of_packages = "/usr/share/doc/disparityd/realtime.conf";
    const fs::path drop_in = "/etc/systemd/system/disparityd.service.d/realtime.conf";
    fs::copy_file(fs::exists(of_packages) ? of_packages : "/vm/realtime.conf", drop_in);
    EXPECT_EQ(run_system_program({"systemctl", "daemon-reload"}).status, 0);
    const Said started = unit_.order("restart");
    EXPECT_EQ(started.status, 0) << started.text << unit_.journal();
    EXPECT_TRUE(unit_.comes_to_say("running, ")) << unit_.property("StatusText");
    int threads = 0;
    for (const auto& thread : fs::directory_iterator("/proc/" + std::to_string(unit_.main_process()) + "/task")) {
        EXPECT_EQ(::sched_getscheduler(std::stoi(thread.path().filename())), SCHED_RR) << thread.path();
        ++threads;
    }
    EXPECT_GT(threads, 3);
    auto client = connected();
    EXPECT_TRUE(new_frame(client));
    fs::remove(drop_in);
    EXPECT_EQ(run_system_program({"systemctl", "daemon-reload"}).status, 0);
    EXPECT_EQ(unit_.order("restart").status, 0);
}

TEST_F(Systemd, StopIsCleanAndLeavesNothing) {
    const int process = unit_.main_process();
    const std::int64_t begin = monotonic_ns();
    const Said stopped = unit_.order("stop");
    std::printf("seconds to stop: %.2f\n", static_cast<double>(monotonic_ns() - begin) * 1e-9);
    EXPECT_EQ(stopped.status, 0) << stopped.text;
    EXPECT_EQ(unit_.property("ActiveState"), "inactive");
    // Neither "timeout" nor "signal".
    EXPECT_EQ(unit_.property("Result"), "success");
    EXPECT_EQ(unit_.property("ExecMainStatus"), "0");
    EXPECT_FALSE(fs::exists("/proc/" + std::to_string(process)));
    EXPECT_FALSE(fs::exists("/run/disparityd/disparityd.sock"));
    EXPECT_FALSE(fs::exists("/dev/shm/disparityd.default"));
    EXPECT_EQ(camera_->counter("streaming"), 0);
}

}  // namespace

}  // namespace vm_guest
