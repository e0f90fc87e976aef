// SPDX-License-Identifier: Apache-2.0
//
// The kernels of the cpu back end, in the manner of dav1d's checkasm:
//   cpu_kernels_check [GoogleTest's options]   every kernel of every instruction set here against the reference
//   cpu_kernels_check --bench [FILTER]         their times beside the reference's; FILTER: a part of their names
//   cpu_kernels_check --help                   GoogleTest's options
#include <cstdio>
#include <cstring>

#include <gtest/gtest.h>

#include "tests/kernels/check/kernel_bench.h"

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    if (argc >= 2 && std::strcmp(argv[1], "--bench") == 0 && argc <= 3) {
        const std::string filter = argc == 3 ? argv[2] : "";
        if (disparityd::test::bench_kernels(filter) == 0) {
            std::fprintf(stderr, "cpu_kernels_check: error: no kernel has '%s' in its name\n", filter.c_str());
            return 2;
        }
        return 0;
    }
    if (argc > 1 && std::strcmp(argv[1], "--help") != 0) {
        std::fprintf(stderr,
                     "cpu_kernels_check: error: found '%s', allowed: GoogleTest's options, or --bench [FILTER]\n",
                     argv[1]);
        return 2;
    }
    return RUN_ALL_TESTS();
}
