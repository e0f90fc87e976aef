// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::test {

/// So many threads can be started from now on, as if the system had a limit; -1: any number.
void allow_threads(int count);

}  // namespace disparityd::test
