// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// sendmsg() and shutdown() of the program that this is linked into, as a slow or broken connection has them.
namespace disparityd::test::limited_sends {

/// Which calls fail: those whose number, counted from 0, is `first`, or `first` plus a multiple of `every`.
struct Failures {
    int error = 0;  ///< errno; 0: none fails
    std::uint64_t first = 0;
    std::uint64_t every = 0;  ///< 0: only `first`
};

/// Each sendmsg() from now on takes at most `bytes`, and some fail.
void limit(std::size_t bytes, const Failures& failures = {});

/// Nothing is limited any more.
void stop();

/// Calls of shutdown() since the program began.
std::uint64_t shutdowns();

}  // namespace disparityd::test::limited_sends
