// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/guest/reading_program.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/vm/guest/waiting.h"

namespace vm_guest {

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

}  // namespace vm_guest
