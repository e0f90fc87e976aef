// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::tools {

/// What a second Ctrl-C does. Other signals may come more than once: they are counted.
enum class SecondSignal {
    ends_the_program,  ///< at once
    is_kept            ///< it is counted: for a program that must still say something to a daemon
};

/// From here on the first Ctrl-C (SIGINT), SIGTERM or lost terminal (SIGHUP, unless it was ignored) only sets a flag,
/// so that the program can finish its files. timeout(1) and Slurm send the program two signals, one of them to its
/// group.
void catch_interrupts(SecondSignal second = SecondSignal::ends_the_program);

/// Whether one has come.
bool interrupted();

/// How many have come.
int interruptions();

/// What the first one was, for messages: "Ctrl-C", "SIGTERM" or "SIGHUP".
std::string interrupted_by();

}  // namespace disparityd::tools
