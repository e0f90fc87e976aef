// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

/// What the program that this is linked into has asked the system for since the last reset(), by malloc and its
/// relatives (operator new among them) and by mmap.
namespace disparityd::test::counted_memory {

void reset();
std::size_t calls();
/// What was freed or unmapped since is not taken off.
std::size_t bytes();

}  // namespace disparityd::test::counted_memory
