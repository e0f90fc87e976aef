// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// operator new of the program that this is linked into, which fails when it is told to.
namespace disparityd::test::failing_memory {

/// Of what threads other than the caller's ask for from now on, number `first` (from 0) and the `count` - 1 after it
/// are refused.
void fail(std::uint64_t first, std::uint64_t count);

/// Of what threads other than the caller's ask for from now on, all that is for more bytes than that is refused.
void fail_above(std::size_t bytes);

/// Nothing is refused any more. Returns how many were.
std::uint64_t stop();

/// The most bytes that one request was for, of those that threads other than the caller's have
/// made since fail() or fail_above().
std::size_t largest();

}  // namespace disparityd::test::failing_memory
