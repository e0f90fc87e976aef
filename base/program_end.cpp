// SPDX-License-Identifier: Apache-2.0
#include "base/program_end.h"

#include <cstdio>
#include <cstdlib>
#include <iostream>

#include <sys/resource.h>

namespace disparityd::base {

int end_program(int code) {
    rlimit memory{};
    if (::getrlimit(RLIMIT_AS, &memory) == 0 && memory.rlim_cur != RLIM_INFINITY) {
        std::cout.flush();
        std::fflush(nullptr);
        std::_Exit(code);
    }
    return code;
}

}  // namespace disparityd::base
