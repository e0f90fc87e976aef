// SPDX-License-Identifier: Apache-2.0
//
// Runs disparityd as a user who may open no device that is not open to all.
#include <cstdio>

#include <grp.h>
#include <unistd.h>

int main(int, char** argv) {
    constexpr unsigned nobody = 65534;
    if (::setgroups(0, nullptr) != 0 || ::setgid(nobody) != 0 || ::setuid(nobody) != 0) {
        std::perror("run_as_nobody");
        return 126;
    }
    ::execv("/vm/disparityd", argv);
    std::perror("/vm/disparityd");
    return 127;
}
