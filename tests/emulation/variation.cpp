// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/cuda/device_under_test.h"
#include "tests/emulation/simt.h"

namespace disparityd::test {

Variation::Variation(int n) {
    constexpr std::array<unsigned char, 2> poisons = {0xa5, 0x00};
    simt::settings() = {static_cast<simt::Order>(n % 3), static_cast<unsigned>(n),
                        poisons[static_cast<std::size_t>(n / 3 % 2)], n % 4 == 0, 1 + n % 3};
}

Variation::~Variation() {
    simt::settings() = {};
}

}  // namespace disparityd::test
