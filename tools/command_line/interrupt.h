// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::tools {

/// From here on the first Ctrl-C (SIGINT), SIGTERM or lost terminal (SIGHUP, unless it was ignored) only sets a flag,
/// so that the program can finish its files. The second one ends it at once.
void catch_interrupts();

/// Whether one has come.
bool interrupted();

}  // namespace disparityd::tools
