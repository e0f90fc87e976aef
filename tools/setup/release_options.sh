# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Sourced from the project's root by tools/demo and tools/test.

# release_options: how they configure a release build that is not there yet, an option on each line. A folder that is there
# keeps what it has.
release_options() {
    [[ ! -e build/release/CMakeCache.txt ]] || return 0
    echo -DDISPARITYD_CUDA=LOCAL
    # Several files at once, which halves the time; who works on the code builds file by file.
    echo -DCMAKE_UNITY_BUILD=ON
}
