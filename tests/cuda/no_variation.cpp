// SPDX-License-Identifier: Apache-2.0
#include "tests/cuda/device_under_test.h"

namespace disparityd::test {

Variation::Variation(int /*n*/) {}
Variation::~Variation() = default;

}  // namespace disparityd::test
