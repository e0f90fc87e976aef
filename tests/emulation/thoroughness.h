// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::test {

/// Under a sanitizer, which watches every switch between the threads of a block, or on an emulated processor the
/// emulated device is ten times slower: there a part of the rounds must do.
#ifdef DISPARITYD_FEWER_ROUNDS
constexpr bool all_rounds = false;
#else
constexpr bool all_rounds = true;
#endif

}  // namespace disparityd::test
