// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::base {

/// Returns the exit code, for main() to return it last. Under a limit of the memory (ulimit -v) it ends the program at
/// once, its output written: the destructors of libraries may wait for ever there. OpenBLAS, which may come with
/// OpenCV, waits for threads that had no memory to start.
int end_program(int code);

}  // namespace disparityd::base
