// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

/// operator new of the program that this is linked into, which notes how much is asked for.
namespace disparityd::test::largest_allocation {

/// Forgets what was asked for before.
void reset();

/// Returns the most bytes that one request was for since reset(), of those of threads other than the one that called
/// it.
std::size_t bytes();

}  // namespace disparityd::test::largest_allocation
