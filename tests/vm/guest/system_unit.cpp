// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/guest/system_unit.h"

#include <array>
#include <cstdlib>
#include <stdexcept>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/vm/guest/waiting.h"

namespace vm_guest {

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

}  // namespace vm_guest
