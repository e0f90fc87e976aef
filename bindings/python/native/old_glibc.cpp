// SPDX-License-Identifier: Apache-2.0
// What the C++ library inside a wheel asks of the C library, and glibc before 2.32 does not have.

extern "C" {
/// Whether no other thread has ever been started, so that reference counts could do without atomic operations. No: that
/// is always right.
__attribute__((visibility("hidden"))) char __libc_single_threaded = 0;  // NOLINT: the C library's name
}
