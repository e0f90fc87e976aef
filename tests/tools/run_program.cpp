// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/run_program.h"

#include <cerrno>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace disparityd::test {
namespace {

constexpr std::chrono::minutes patience{2};
constexpr std::chrono::milliseconds poll_interval{5};

std::vector<std::string> emulator() {
    std::istringstream words(DISPARITYD_EMULATOR);
    std::vector<std::string> command;
    for (std::string word; words >> word;) {
        command.push_back(word);
    }
    return command;
}

std::string contents(int fd) {
    // The position in the file is shared with the program: it must not move.
    struct stat facts {};
    fstat(fd, &facts);
    std::string text(static_cast<std::size_t>(facts.st_size), '\0');
    const ssize_t count = pread(fd, text.data(), text.size(), 0);
    text.resize(count < 0 ? 0 : static_cast<std::size_t>(count));
    return text;
}

}  // namespace

Program::Program(const std::string& path, const std::vector<std::string>& arguments)
    : out_(memfd_create("stdout", MFD_CLOEXEC)), err_(memfd_create("stderr", MFD_CLOEXEC)) {
    std::vector<std::string> words = emulator();
    words.push_back(path);
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) {
        argv.push_back(word.data());
    }
    argv.push_back(nullptr);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, out_, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, err_, STDERR_FILENO);
    // Below nohup the program would leave alone the lost terminal that a test sends.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t by_default;
    sigemptyset(&by_default);
    sigaddset(&by_default, SIGHUP);
    posix_spawnattr_setsigdefault(&attributes, &by_default);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    const int error = posix_spawnp(&pid_, argv[0], &actions, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) {
        pid_ = -1;
        throw std::runtime_error(words[0] + ": " + std::strerror(error));
    }
}

Program::~Program() {
    if (pid_ > 0 && running()) {
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    close(out_);
    close(err_);
}

void Program::send(int signal) const {
    kill(pid_, signal);
}

bool Program::running() {
    if (!ended_ && waitpid(pid_, &wait_status_, WNOHANG) == pid_) {
        ended_ = true;
    }
    return !ended_;
}

bool Program::said(const std::string& text) const {
    return (contents(out_) + contents(err_)).find(text) != std::string::npos;
}

Outcome Program::wait() {
    if (!eventually([this] { return !running(); })) {
        throw std::runtime_error("the program does not end; it said so far: " + contents(out_) + contents(err_));
    }
    const int code = WIFEXITED(wait_status_) ? WEXITSTATUS(wait_status_) : 128 + WTERMSIG(wait_status_);
    return {code, contents(out_), contents(err_)};
}

Outcome run(const std::string& path, const std::vector<std::string>& arguments) {
    return Program(path, arguments).wait();
}

bool eventually(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > deadline) {
            return false;
        }
        std::this_thread::sleep_for(poll_interval);
    }
    return true;
}

}  // namespace disparityd::test
