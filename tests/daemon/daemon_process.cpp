// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/daemon_process.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

namespace disparityd::test {
namespace {

using std::chrono::steady_clock;

std::string contents_of(const std::string& path) {
    std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// How the program is started: itself, or by an emulator when it was built for another machine.
std::vector<std::string> command_line(const std::string& program, const std::vector<std::string>& arguments) {
    std::vector<std::string> command;
    std::istringstream emulator(DISPARITYD_EMULATOR);
    for (std::string word; emulator >> word;) {
        command.push_back(word);
    }
    command.push_back(program);
    command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
}

}  // namespace

DaemonProcess::DaemonProcess(const TemporaryFolder& folder, std::vector<std::string> arguments,
                             const Environment& environment, const std::string& program) {
    static int count = 0;
    log_path_ = folder.path() + "/log" + std::to_string(count++);
    std::array<int, 2> out{};
    if (pipe2(out.data(), O_CLOEXEC) != 0) {
        throw std::runtime_error("no pipe");
    }
    std::vector<std::string> command = command_line(program, arguments);
    std::vector<char*> words;
    std::transform(command.begin(), command.end(), std::back_inserter(words),
                   [](std::string& word) { return word.data(); });
    words.push_back(nullptr);
    const int log = open(log_path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    pid_ = fork();
    if (pid_ == 0) {
        dup2(out[1], STDOUT_FILENO);
        dup2(log, STDERR_FILENO);
        for (const auto& [name, value] : environment) {
            setenv(name.c_str(), value.c_str(), 1);
        }
        if (chdir(folder.path().c_str()) == 0) {
            execvp(words[0], words.data());
        }
        _exit(127);
    }
    close(out[1]);
    close(log);
    stdout_ = out[0];
}

DaemonProcess::~DaemonProcess() {
    if (!exit_status_) {
        send_signal(SIGKILL);
        wait_for_exit();
    }
    close(stdout_);
}

bool DaemonProcess::read_line(std::string& line, steady_clock::time_point deadline) {
    for (;;) {
        const auto end = unread_.find('\n');
        if (end != std::string::npos) {
            line = unread_.substr(0, end);
            unread_.erase(0, end + 1);
            return true;
        }
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now()).count();
        pollfd event{stdout_, POLLIN, 0};
        if (poll(&event, 1, static_cast<int>(std::max<std::int64_t>(0, left))) <= 0) {
            return false;
        }
        std::array<char, 4096> bytes{};
        const ssize_t got = read(stdout_, bytes.data(), bytes.size());
        if (got <= 0) {
            return false;
        }
        unread_.append(bytes.data(), static_cast<std::size_t>(got));
    }
}

bool DaemonProcess::wait_until_ready(std::chrono::milliseconds timeout) {
    const auto deadline = steady_clock::now() + timeout;
    for (std::string line; read_line(line, deadline);) {
        if (line == "ready") {
            return true;
        }
        addresses_.push_back(line);
    }
    return false;
}

bool DaemonProcess::wait_for_line(const std::function<bool(const std::string&)>& wanted,
                                  std::chrono::milliseconds timeout) {
    const auto deadline = steady_clock::now() + timeout;
    for (std::string line; read_line(line, deadline);) {
        if (wanted(line)) {
            return true;
        }
    }
    return false;
}

std::string DaemonProcess::address(const std::string& prefix) const {
    const auto found = std::find_if(addresses_.begin(), addresses_.end(),
                                    [&prefix](const std::string& candidate) { return candidate.starts_with(prefix); });
    return found == addresses_.end() ? "" : *found;
}

void DaemonProcess::send_signal(int signal) const {
    kill(pid_, signal);
}

std::optional<int> DaemonProcess::wait_for_exit(std::chrono::milliseconds timeout) {
    const auto deadline = steady_clock::now() + timeout;
    while (!exit_status_) {
        int status = 0;
        if (waitpid(pid_, &status, WNOHANG) == pid_) {
            exit_status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
            for (std::string line; read_line(line, steady_clock::now());) {
                output_ += line + '\n';
            }
        } else if (steady_clock::now() > deadline) {
            return std::nullopt;
        } else {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
    }
    return exit_status_;
}

std::string DaemonProcess::log() const {
    return contents_of(log_path_);
}

bool DaemonProcess::wait_for_log(const std::string& text, std::chrono::milliseconds timeout) const {
    const auto deadline = steady_clock::now() + timeout;
    while (log().find(text) == std::string::npos) {
        if (steady_clock::now() > deadline) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
}

double DaemonProcess::peak_memory_mib() const {
    std::istringstream status(contents_of("/proc/" + std::to_string(pid_) + "/status"));
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("VmHWM:")) {
            return std::stod(line.substr(6)) / 1024;
        }
    }
    return 0;
}

}  // namespace disparityd::test
