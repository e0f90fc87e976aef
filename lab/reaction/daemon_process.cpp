// SPDX-License-Identifier: Apache-2.0
#include "lab/reaction/daemon_process.h"

#include <cerrno>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

namespace disparityd::reaction {
namespace {

std::string last_line(const std::string& path) {
    std::ifstream file(path);
    std::string last = "it has said nothing";
    for (std::string line; std::getline(file, line);) {
        last = line;
    }
    return last;
}

}  // namespace

DaemonProcess::DaemonProcess(const std::string& program, const std::vector<std::string>& arguments,
                             const std::string& log)
    : program_(program), log_(log) {
    std::vector<char*> words{program_.data()};
    std::vector<std::string> copies = arguments;
    for (std::string& copy : copies) {
        words.push_back(copy.data());
    }
    words.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ < 0) {
        throw std::system_error(errno, std::generic_category(), program + " cannot be started");
    }
    if (pid_ == 0) {
        const int to = ::open(log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
        ::dup2(to, STDOUT_FILENO);
        ::dup2(to, STDERR_FILENO);
        ::execv(program_.c_str(), words.data());
        ::_exit(127);
    }
}

DaemonProcess::~DaemonProcess() {
    if (pid_ > 0) {
        ::kill(pid_, SIGTERM);
        while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
        }
    }
}

void DaemonProcess::check() {
    int status = 0;
    if (pid_ > 0 && ::waitpid(pid_, &status, WNOHANG) == pid_) {
        pid_ = -1;
        const bool absent = WIFEXITED(status) && WEXITSTATUS(status) == 127;
        throw std::runtime_error(program_ + (absent ? " cannot be run: build it, or say with --bin where it is"
                                                    : " has ended: " + last_line(log_)));
    }
}

}  // namespace disparityd::reaction
