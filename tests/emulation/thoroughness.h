// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::test {

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define DISPARITYD_SANITIZED 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define DISPARITYD_SANITIZED 1
#endif

/// Sanitizers watch every switch between the threads of a block, which makes the emulation ten times slower: there a
/// part of the rounds must do.
#ifdef DISPARITYD_SANITIZED
constexpr bool all_rounds = false;
#else
constexpr bool all_rounds = true;
#endif

}  // namespace disparityd::test
