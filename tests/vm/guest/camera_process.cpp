// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/guest/camera_process.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/vm/camera/command_socket.h"
#include "tests/vm/guest/waiting.h"

namespace vm_guest {

namespace {

constexpr const char* program = "/vm/simulated_camera";

pid_t start(std::vector<std::string> arguments) {
    std::vector<char*> pointers;
    for (std::string& each : arguments) {
        pointers.push_back(each.data());
    }
    pointers.push_back(nullptr);
    const pid_t process = ::fork();
    if (process == 0) {
        ::execv(program, pointers.data());
        ::_exit(127);
    }
    return process;
}

}  // namespace

CameraProcess::CameraProcess(std::vector<std::string> options) {
    static std::atomic<int> cameras{0};
    socket_ = "/run/camera" + std::to_string(++cameras);
    for (const VideoNode& each : usb_video_nodes()) {
        nodes_before_.push_back(each.usb_path);
    }
    options.insert(options.begin(), {program, "--socket", socket_});
    process_ = start(std::move(options));
    if (!eventually([this] { return find_node(); })) {
        throw std::runtime_error("the simulated camera has no video node");
    }
}

CameraProcess::~CameraProcess() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    eventually([this] { return !find_node(); });
}

bool CameraProcess::find_node() {
    for (const VideoNode& each : usb_video_nodes()) {
        if (std::find(nodes_before_.begin(), nodes_before_.end(), each.usb_path) == nodes_before_.end()) {
            node_ = each;
            return true;
        }
    }
    return false;
}

std::string CameraProcess::tell(const std::string& command) const {
    const std::string answer = simulated_camera::send_command(socket_, command);
    if (answer.empty() || answer.starts_with("error")) {
        throw std::runtime_error("camera, " + command + ": " + answer);
    }
    return answer;
}

long CameraProcess::counter(const std::string& name) const {
    std::istringstream words(tell("status"));
    std::string word;
    while (words >> word) {
        if (word.starts_with(name + "=")) {
            return std::strtol(word.c_str() + name.size() + 1, nullptr, 10);
        }
    }
    throw std::runtime_error("the camera's status has no " + name);
}

void CameraProcess::unplug() {
    tell("unplug");
    if (!eventually([this] { return !find_node(); })) {
        throw std::runtime_error("the unplugged camera still has a video node");
    }
}

void CameraProcess::plug(const std::string& as) {
    tell("plug " + as);
    if (!eventually([this] { return find_node(); })) {
        throw std::runtime_error("the camera that was plugged in has no video node");
    }
}

}  // namespace vm_guest
