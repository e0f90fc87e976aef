// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::test {

/// Under a sanitizer, which watches every switch between the threads of a block, or on an emulated processor the
/// emulated device is ten times slower: there one of so many rounds must do.
#ifdef DISPARITYD_ONE_ROUND_OF
constexpr int one_round_of = DISPARITYD_ONE_ROUND_OF;
#else
constexpr int one_round_of = 1;
#endif
constexpr bool all_rounds = one_round_of == 1;

}  // namespace disparityd::test
